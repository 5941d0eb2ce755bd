// SPDX-License-Identifier: MIT
// Parts of `tandem run`.
#pragma once

#include "harness/plans/job.h"
#include "harness/plans/cell_groups.h"

namespace tandem {

/// How cells are measured according to the options. The caller sets the truths.
Measuring measuring_of(const RunOptions& options);

/// Prints which cells are not measured, and why, on standard error.
void print_left_out(const CellGroups& all);
void print_skipped(const InputError& error);

/// Prints the tables of the measured cells and the verdict on each.
void print_results(std::span<const CellResult* const> results);

} // namespace tandem
