// SPDX-License-Identifier: MIT
// Parts of `tandem run`.
#pragma once

#include "harness/plans/job.h"
#include "harness/plans/cell_groups.h"

namespace tandem {

/// The plan of the options, or one of a single product.
PlanFile plan_of(const RunOptions& options);

/// What of the options says how cells are measured; truths are the caller's.
Measuring measuring_of(const RunOptions& options);

/// Says what is not measured, and why.
void tell_left_out(const CellGroups& all);
void tell_skipped(const InputError& error);

/// The tables of the cells that were measured, and what is to be thought of each.
void print_results(std::span<const CellResult* const> results);

} // namespace tandem
