// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace tandem {

/// Whether an MPI launcher started this process, according to its environment.
bool has_launcher();

/// Number of independent tasks that srun started, this one included, with --mpi=none (Slurm's default); 1 in
/// every other case.
int tasks_without_mpi();

/// This process's environment without the variables of an MPI launcher, for child processes outside the job.
/// Pointers into the environment, terminated by a null.
std::vector<char*> environment_without_launcher();

} // namespace tandem
