// SPDX-License-Identifier: MIT
// What `tandem run` prints of its results.
#pragma once

#include "harness/measuring/measure.h"
#include "harness/record/verdict.h"

namespace tandem {

/// The measured cells among the results, in order.
std::vector<Row> rows_of(const Task& task, std::span<const CellResult* const> results);

/// Prints the table of the rows, whether the answers of the measured results are right, doubts about their
/// times, and the verdicts.
void print_results(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Task& task,
                   std::span<const CellResult* const> results);

} // namespace tandem
