// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/measurement.h"

#include <span>
#include <string>

namespace tandem {

/// A finished cell for the printed tables.
struct Row {
    const Cell* cell;
    const Measurement* measurement;
    std::string scene = {}; ///< with frames; cells of one are comparable
};

/// Cells in at most 100 columns, in milliseconds a frame: medians with half the width of their 95 % intervals
/// and what was found; stages by the device's clock where they are not 0 everywhere (preprocess and
/// postprocess, and broad where the host finds the body pairs, by the host's), beside the frame of the same
/// replays, which a clock around every command slows; then how many times as long as the first comparable
/// cell each takes, in the columns of the paper's Table 4. Labels have what differs among the cells. `colour`
/// marks the fastest of comparable cells and wrong ones.
std::string result_tables(std::span<const Row> rows, bool colour);

/// How many times as long the first takes, with its 95 % interval where there are rounds; "≈" before it where
/// that has 1 in it, "-" without samples.
std::string ratio_text(const Measurement& above, const Measurement& below);

/// Whether times of the two may be divided: one scene, devices, bounds (k, axes, precision, rounding,
/// placement) and output, both right and with pairs.
bool comparable(const Row& a, const Row& b);

} // namespace tandem
