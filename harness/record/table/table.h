// SPDX-License-Identifier: MIT
#pragma once

#include "base/columns.h"
#include "harness/record/verdict.h"

#include <span>
#include <string>

namespace tandem {

/// How tables are printed.
struct TableStyle {
    TableFormat format = TableFormat::text;
    bool colour = false; ///< marks wrong cells, and the fastest of comparable ones with those not told apart
    std::vector<std::string> throughput{}; ///< names of further columns (throughput.h)
};

/// Tables of rows of one scene, in milliseconds a frame. The first has medians, half the width of their 95 %
/// intervals, counts and throughput. The second has the stages of the instrumented replays, which are slower:
/// by the host's clock for the host's work, by the device's otherwise. One table a cell follows for several
/// devices. The last has ratios to the first comparable cell, in the columns of the paper's Table 4. The
/// verdicts follow, a sentence each. Cells have their names of describe(). `verdicts` are those of the rows.
std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Scene& scene,
                          const TableStyle& style);

} // namespace tandem
