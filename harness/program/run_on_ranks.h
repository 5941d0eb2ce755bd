// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <functional>
#include <string>
#include <vector>

namespace tandem {

/// A program's work in two steps: reads the command line and returns the function that runs the command.
using ReadLine = std::function<std::function<int()>()>;
/// Runs the work, prints its error if there is one, and returns the exit code.
using Guard = std::function<int(const std::function<int()>&)>;

/// Runs the command line of a process of an MPI job: `run` on all ranks, any other command on rank 0 while
/// the other ranks wait. All ranks return the same exit code. It is 2, after a message from rank 0, when
/// programs or command lines differ between ranks. An error of a single rank ends the job with 3.
int run_on_ranks(Ranks& ranks, const std::vector<std::string>& words, const ReadLine& read,
                 const Guard& guard);

/// For a command that runs on one rank: prints to standard error that the other ranks wait, if there are any.
void report_idle_ranks(const std::string& command);

/// For a run without MPI: prints to standard error, once for all tasks of an srun, that they are not ranks.
void warn_tasks_are_no_ranks();

} // namespace tandem
