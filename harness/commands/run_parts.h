// SPDX-License-Identifier: MIT
// Parts of `tandem run`.
#pragma once

#include "harness/measuring/measure.h"
#include "harness/plans/cell_groups.h"
#include "harness/record/verdict.h"

namespace tandem {

/// How cells are measured according to the options. The caller sets the truths.
Measuring measuring_of(const RunOptions& options);

/// Prints which cells are not measured, and why, on standard error.
void print_left_out(const CellGroups& all);
void print_skipped(const InputError& error);

/// The measured cells among the results, in order.
std::vector<Row> rows_of(const Task& task, std::span<const CellResult* const> results);

/// Prints the tables of the rows with their verdicts, and for each measured result whether its answer is
/// right.
void print_results(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Task& task,
                   std::span<const CellResult* const> results);

} // namespace tandem
