// SPDX-License-Identifier: MIT
#pragma once

#include "harness/record/verdict.h"

#include <span>
#include <string>

namespace tandem {

/// Tables of at most 100 columns, in milliseconds a frame. The first has medians, half the width of their 95
/// % intervals, and counts. The second has the stages of the instrumented replays, which are slower: by the
/// host's clock for the host's work, by the device's otherwise. One table a cell follows for several devices.
/// The last has ratios to the first comparable cell, in the columns of the paper's Table 4. The verdicts
/// follow, a sentence each. Labels contain what differs among the cells. `verdicts` are those of the rows.
/// `colour` marks wrong cells, and the fastest of comparable ones with those that are not told apart from it.
std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, bool colour);

} // namespace tandem
