// SPDX-License-Identifier: MIT
// What `tandem run` prints of its results.
#pragma once

#include "harness/measuring/measure.h"
#include "harness/record/verdict.h"

namespace tandem {

/// The measured cells among the results, in order.
std::vector<Row> rows_of(const Task& task, std::span<const CellResult* const> results);

/// Prints the tables of the rows with their verdicts, and for each measured result whether its answer is
/// right.
void print_results(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Task& task,
                   std::span<const CellResult* const> results);

} // namespace tandem
