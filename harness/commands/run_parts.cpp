// SPDX-License-Identifier: MIT
#include "harness/commands/run_parts.h"
#include "harness/measuring/measure.h"

#include "base/standard_streams.h"
#include "harness/plans/key.h"
#include "harness/record/table/table.h"
#include "harness/program/interrupt.h"
#include "harness/sampling/turns.h"
#include "harness/record/answer.h"

#include <fmt/format.h>
#include <random>

namespace tandem {

void print_left_out(const CellGroups& all) {
    if (all.repeated > 0)
        print_message("tandem: {} cells are named more than once; each is measured once\n", all.repeated);
    for (const auto& [reason, count] : all.impossible)
        print_message("tandem: skipped {} impossible combination{}: {}\n", count, count == 1 ? "" : "s",
                      reason);
}

void print_skipped(const InputError& error) { print_message("tandem: skipped a cell: {}\n", error.what()); }

Measuring measuring_of(const RunOptions& options) {
    Measuring measuring;
    measuring.check = {options.check, options.count, nullptr};
    measuring.stopping = {options.repeat, options.noise, options.seconds};
    const auto turns = Turns::from_environment();
    measuring.seed = options.seed ? *options.seed : turns ? turns->seed() : std::random_device{}();
    if (turns) measuring.before_round = [turns = *turns] { turns.wait(Interrupt::asked); };
    return measuring;
}

std::vector<Row> rows_of(const Task& task, std::span<const CellResult* const> results) {
    std::vector<Row> rows;
    for (const auto* result : results)
        if (const auto& m = result->measurement; result->measured)
            rows.push_back({result->cell, &m, key_of(*result->cell, m.settings, task.scene, task.range)});
    return rows;
}

void print_results(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Task& task,
                   std::span<const CellResult* const> results) {
    if (rows.empty()) return;
    const bool is_text = task.options.format == TableFormat::text;
    put_text("\n"
             + result_tables(rows, verdicts, task.scene,
                             {task.options.format, is_text && prints_colour(), task.options.columns})
             + "\n");
    for (const auto* result : results) {
        if (!result->measured) continue;
        const auto doubt = doubts(*result);
        put("{}: {}\n", describe(*result->cell), answer_text(result->measurement));
        for (const auto& line : answer_warnings(result->measurement, task.scene)) put("  {}\n", line);
        if (!doubt.empty()) put("  {}\n", doubt);
    }
}

} // namespace tandem
