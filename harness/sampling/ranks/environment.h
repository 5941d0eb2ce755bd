// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace tandem {

/// Whether the environment is one that a launcher of MPI made for the processes it starts.
bool has_launcher();

/// How many tasks srun has started beside this one, itself included, none of which is told of the others
/// (--mpi=none, Slurm's default); 1 elsewhere.
int tasks_without_mpi();

/// This process's environment without what a launcher of MPI put there, for processes that are none of its
/// job: pointers into the environment, a null at the end.
std::vector<char*> environment_without_launcher();

} // namespace tandem
