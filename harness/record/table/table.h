// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"

#include <span>
#include <string>

namespace tandem {

/// A finished cell in the printed tables.
struct Row {
    const Cell* cell;
    const Measurement* measurement;
    std::string scene = {}; ///< with frames; only cells of the same scene are comparable
};

/// Tables of at most 100 columns, in milliseconds a frame. The first has medians, half the width of their 95
/// % intervals, and counts. The second has the stages of the instrumented replays, which are slower: by the
/// host's clock for the host's work, by the device's otherwise. One table a cell follows for several devices.
/// The last has ratios to the first comparable cell, in the columns of the paper's Table 4. Labels contain
/// what differs among the cells. `colour` marks wrong cells and the fastest of comparable ones.
std::string result_tables(std::span<const Row> rows, bool colour);

/// Ratio of the two times, with its 95 % interval when both have at least two rounds. "≈" precedes it when
/// the interval contains 1; "-" without samples.
std::string ratio_text(const Measurement& above, const Measurement& below);

/// Whether the ratio of two cells' times has a meaning: equal scene, devices, bounds (k, axes, precision,
/// rounding, placement, origin) and output, and both right with at least one pair.
bool comparable(const Row& a, const Row& b);

} // namespace tandem
