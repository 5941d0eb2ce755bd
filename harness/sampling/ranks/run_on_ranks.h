// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <functional>
#include <string>
#include <vector>

namespace tandem {

/// A program's work in two steps: what reads its command line returns what to do.
using ReadLine = std::function<std::function<int()>()>;
/// Prints the error of the work, if there is one, and returns the exit code.
using Guard = std::function<int(const std::function<int()>&)>;

/// Runs the command line of a process of an MPI job: `run` on all ranks together, every other command on rank
/// 0, while the other ranks wait. Returns the exit code, the same on every rank; 2, after one line of rank 0,
/// where programs or their lines are not the same on all ranks. An error of one rank ends the job with 3.
int run_on_ranks(Ranks& ranks, const std::vector<std::string>& words, const ReadLine& read,
                 const Guard& guard);

/// Of a command that one rank does by itself: says on standard error that the others wait, where there are
/// others.
void report_idle_ranks(const std::string& command);

/// Of a run by itself: says on standard error, once for all tasks of an srun, that they are no ranks.
void warn_tasks_are_no_ranks();

} // namespace tandem
