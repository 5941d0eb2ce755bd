// SPDX-License-Identifier: MIT
// What `tandem run` does in the same way in one process and over ranks.
#pragma once

#include "harness/job.h"
#include "harness/plans/cell_groups.h"

namespace tandem {

/// The plan of the options, or one of a single product.
PlanFile plan_of(const RunOptions& options);

/// What of the options says how cells are measured; truths are the caller's.
Measuring measuring_of(const RunOptions& options);

/// Says what is not measured, and why.
void tell_left_out(const CellGroups& all);
void tell_skipped(const InputError& error);

/// The tables of the cells that were measured, and what is to be thought of each. `where` names the place of
/// each; left out it is its devices' name.
void print_results(std::span<const CellResult* const> results, std::span<const std::string> where = {});

} // namespace tandem
