// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <memory>
#include <string>

namespace tandem {

/// Initialises MPI for its lifetime when an MPI launcher (mpirun, srun) started this process; does nothing
/// otherwise. Create one in main(). Throws InputError when a launcher started a program built without MPI,
/// because all processes would do the same work and write the same files.
class MpiEnvironment {
public:
    MpiEnvironment();
    ~MpiEnvironment();
    MpiEnvironment(const MpiEnvironment&) = delete;
    MpiEnvironment& operator=(const MpiEnvironment&) = delete;

private:
    std::unique_ptr<Ranks> ranks_;
};

/// The ranks of this process's job; null without a launcher, or in a job of one process.
Ranks* job_ranks();

/// The MPI library, such as "Open MPI v4.1.4", or a sentence why there is none.
std::string mpi_library_version();

} // namespace tandem
