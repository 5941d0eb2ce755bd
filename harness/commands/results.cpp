// SPDX-License-Identifier: MIT
#include "harness/commands/results.h"

#include "base/standard_streams.h"
#include "harness/plans/key.h"
#include "harness/record/table/table.h"
#include "harness/record/answer.h"

#include <fmt/format.h>

namespace tandem {

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
