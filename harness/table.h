// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampler.h"

#include <string>

namespace tandem {

/// A finished cell for the printed table.
struct Row {
    const Cell* cell;
    const Measurement* measurement;
};

/// The form of the paper's Table 5: milliseconds per stage over all frames, launches, waits, pairs, contacts.
/// Kernel and transfer columns are device times, preprocess and postprocess host times, broad that of whoever
/// finds the body pairs, total the median sample.
std::string stage_table(std::span<const Row> rows);

/// The form of the paper's Table 4: how many times longer each row of another algorithm takes than each row
/// of the first row's algorithm on the same devices, in total, narrow phase, kernels alone, reads, writes and
/// launches.
std::string speedup_table(std::span<const Row> rows);

} // namespace tandem
