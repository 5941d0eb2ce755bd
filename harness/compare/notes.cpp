// SPDX-License-Identifier: MIT
#include "harness/compare/labels.h"
#include "harness/compare/report.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace tandem::compare {

namespace {

using Names = std::map<const RecordedCell*, std::string>;

/// Labels that tell all cells of both files apart, those without a counterpart and those left out included.
Names names_of_all(const Report& report) {
    std::vector<const RecordedCell*> cells;
    for (const auto& cell : report.comparison.cells) cells.push_back(cell.before);
    for (const auto* only : {&report.comparison.only_old, &report.comparison.only_new})
        cells.insert(cells.end(), only->begin(), only->end());
    for (const auto* side : {&report.before, &report.after})
        for (const auto& cell : side->left_out) cells.push_back(&cell);
    const auto labels = label(cells);
    Names names;
    for (std::size_t i = 0; i < cells.size(); ++i) names[cells[i]] = one_line(labels.of[i], 1000);
    return names;
}

std::string change_of(const char* what, const std::optional<Answer>& before,
                      const std::optional<Answer>& after) {
    if (!before || !after || *before == *after) return {};
    if (before->count == after->count) return fmt::format("{} {} others", before->count, what);
    return fmt::format("{} {} for {}", after->count, what, before->count);
}

void note_answers(const Report& report, const Names& names, std::vector<std::string>& notes) {
    for (const auto& cell : report.comparison.cells) {
        if (cell.verdict != Verdict::another_answer) continue;
        const auto pairs = change_of("candidate pairs", cell.before->pairs, cell.after->pairs);
        const auto contacts = change_of("contacts", cell.before->contacts, cell.after->contacts);
        notes.push_back(fmt::format("another answer: {}: {}{}{}", names.at(cell.before), pairs,
                                    pairs.empty() || contacts.empty() ? "" : ", ", contacts));
    }
}

/// Why a record takes no part.
std::string reason(const RecordedCell& cell) {
    if (cell.status == "failed") return "failed: " + one_line(cell.failure, 160);
    if (cell.status != "ok") return "its answer is not the reference's";
    return "it has no samples";
}

void note_left_out(const RecordedCells& side, const Names& names, std::vector<std::string>& notes) {
    constexpr std::size_t most = 10;
    for (std::size_t i = 0; i < std::min(most, side.left_out.size()); ++i) {
        const auto& cell = side.left_out[i];
        notes.push_back(
            fmt::format("{}:{} takes no part: {}: {}", side.path, cell.line, names.at(&cell), reason(cell)));
    }
    if (side.left_out.size() > most)
        notes.push_back(fmt::format("{}: {} more records take no part; --format json lists them", side.path,
                                    side.left_out.size() - most));
}

void note_only(const char* which, const std::vector<const RecordedCell*>& cells, const Names& names,
               std::vector<std::string>& notes) {
    if (cells.empty()) return;
    constexpr std::size_t most = 5;
    std::vector<std::string> some;
    for (std::size_t i = 0; i < std::min(most, cells.size()); ++i) some.push_back(names.at(cells[i]));
    if (cells.size() > most) some.push_back(fmt::format("and {} more", cells.size() - most));
    notes.push_back(fmt::format("{} {} in {} only: {}", cells.size(),
                                cells.size() == 1 ? "cell is" : "cells are", which, fmt::join(some, "; ")));
}

void note_file(const RecordedCells& side, std::vector<std::string>& notes) {
    if (side.torn)
        notes.push_back(fmt::format(
            "{}: the last line has no end, being cut off or still written: it is ignored", side.path));
    if (side.repeated > 0)
        notes.push_back(fmt::format("{}: {} {} recorded more than once; the last record that is ok counts",
                                    side.path, side.repeated,
                                    side.repeated == 1 ? "cell was" : "cells were"));
}

std::string name_of(const RecordedCell& cell, std::string_view name) {
    if (name == "processor") return cell.processor.empty() ? "unknown" : cell.processor;
    return std::ranges::find(cell.names, name, &std::pair<std::string, std::string>::first)->second;
}

/// Keys of schema 2 do not say where a cell ran.
void note_machines(const Comparison& comparison, std::vector<std::string>& notes) {
    for (const auto* name : {"model", "driver", "processor"}) {
        std::set<std::string> before;
        std::set<std::string> after;
        for (const auto& cell : comparison.cells) {
            before.insert(name_of(*cell.before, name));
            after.insert(name_of(*cell.after, name));
        }
        if (before != after)
            notes.push_back(fmt::format("other {}s: old {}, new {}", name, fmt::join(before, " and "),
                                        fmt::join(after, " and ")));
    }
}

/// What p cannot know: only within a session are changes of the machine shared by both.
void note_separate_runs(const Comparison& comparison, std::vector<std::string>& notes) {
    const auto apart = std::ranges::count(comparison.cells, false, &ComparedCell::paired);
    if (apart > 0)
        notes.push_back(
            fmt::format("{} of {} cells were measured in separate runs: load, clocks and preparation of "
                        "each run count as changes",
                        apart, comparison.cells.size()));
}

} // namespace

std::vector<std::string> notes(const Report& report) {
    std::vector<std::string> notes;
    const auto names = names_of_all(report);
    note_answers(report, names, notes);
    std::error_code ignored;
    if (std::filesystem::equivalent(report.before.path, report.after.path, ignored)
        && report.before.commit == report.after.commit)
        notes.emplace_back("old and new are the same records; FILE@COMMIT names those of one commit");
    note_file(report.before, notes);
    if (report.before.path != report.after.path || report.before.commit != report.after.commit)
        note_file(report.after, notes);
    note_left_out(report.before, names, notes);
    note_left_out(report.after, names, notes);
    note_only("old", report.comparison.only_old, names, notes);
    note_only("new", report.comparison.only_new, names, notes);
    note_machines(report.comparison, notes);
    note_separate_runs(report.comparison, notes);
    return notes;
}

} // namespace tandem::compare
