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

/// The name of a row among `rows`: without the devices and settings that all have. They stand above tables.
std::string label_of(const Row& row, std::span<const Row> rows);

/// A table of rows of one scene, below a line of what they have in common: medians in milliseconds per frame
/// with half the width of their 95 % intervals, times to that of the fastest comparable cell, the parts of a
/// frame from the instrumented replays, which are slower, and counts. Parts are by the host's clock for the
/// host's work, by the device's otherwise. One table per cell follows for several devices. `verdicts` are
/// those of the rows.
std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Scene& scene,
                          const TableStyle& style);

} // namespace tandem
