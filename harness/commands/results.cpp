// SPDX-License-Identifier: MIT
#include "harness/commands/results.h"

#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "harness/plans/key.h"
#include "harness/record/table/table.h"
#include "harness/record/answer.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>

namespace tandem {

std::vector<Row> rows_of(const Task& task, std::span<const CellResult* const> results) {
    std::vector<Row> rows;
    for (const auto* result : results)
        if (const auto& m = result->measurement; result->measured)
            rows.push_back({result->cell, &m, key_of(*result->cell, m.settings, task.scene, task.range)});
    return rows;
}

namespace {

/// Texts in their order, each with the names of the cells that have it.
using Shared = std::vector<std::pair<std::string, std::vector<std::string>>>;

void add(Shared& shared, const std::string& text, const std::string& name) {
    auto found = std::ranges::find(shared, text, &Shared::value_type::first);
    if (found == shared.end()) found = shared.insert(shared.end(), {text, {}});
    found->second.push_back(name);
}

void put_paragraph(const std::string& text) { put_text(paragraph(text, 2, output_columns())); }

/// "all 3 right: ...", or a line for each different answer.
void print_answers(std::span<const CellResult* const> measured) {
    Shared answers;
    for (const auto* result : measured)
        add(answers, answer_text(result->measurement), describe(*result->cell));
    for (const auto& [text, names] : answers) {
        if (answers.size() > 1)
            put_paragraph(fmt::format("{}: {}", fmt::join(names, ", "), text));
        else
            put_paragraph(names.size() > 1 ? fmt::format("all {} {}", names.size(), text) : text);
    }
}

void print_notes(std::span<const CellResult* const> measured, const Scene& scene) {
    std::vector<std::string> warnings; // each once, although several cells may have it
    for (const auto* result : measured)
        for (const auto& line : answer_warnings(result->measurement, scene))
            if (std::ranges::find(warnings, line) == warnings.end()) warnings.push_back(line);
    for (const auto& line : warnings) put("{}\n", line);
    if (const auto text = disturbed_text(measured); !text.empty()) put_paragraph(text);
    if (const auto text = doubts(measured); !text.empty()) put_paragraph(text);
}

} // namespace

void print_results(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Task& task,
                   std::span<const CellResult* const> results) {
    if (rows.empty()) return;
    const bool is_text = task.options.format == TableFormat::text;
    put_text("\n"
             + result_tables(rows, verdicts, task.scene,
                             {task.options.format, is_text && prints_colour(), task.options.columns})
             + "\n");
    std::vector<const CellResult*> measured;
    std::ranges::copy_if(results, std::back_inserter(measured), &CellResult::measured);
    print_answers(measured);
    print_notes(measured, task.scene);
    std::vector<std::string> names;
    for (const auto& row : rows) names.push_back(label_of(row, rows));
    for (const auto& verdict : verdicts)
        put_paragraph(verdict_scope(verdict, verdicts, rows) + verdict_sentence(verdict, rows, names));
}

} // namespace tandem
