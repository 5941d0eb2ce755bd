// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <functional>
#include <string>
#include <vector>

namespace tandem {

/// What a process of a job of MPI does: the first rank does the command, the others what it asks of them
/// until it has ended. Returns the exit code, the command's on every rank; 2, after one line of the first
/// rank's, where programs or their lines are not the same on all.
int run_launched(Ranks& ranks, const std::vector<std::string>& words, const std::function<int()>& command);

/// Of a command that one rank does by itself: says on standard error that the others wait, where there are
/// others.
void tell_others_wait(const std::string& command);

/// Of a run by itself: says on standard error, once for all tasks of an srun, that they are no ranks.
void tell_tasks_are_no_ranks();

} // namespace tandem
