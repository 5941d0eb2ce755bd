// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <memory>
#include <string>

namespace tandem {

/// MPI for as long as it lives, where a launcher of MPI (mpirun, srun) started this process; otherwise
/// nothing is loaded and nothing changes. One in main(). Throws InputError where there was a launcher and the
/// program was built without MPI: its copies would all do the same work, and write the same files.
class MpiEnvironment {
public:
    MpiEnvironment();
    ~MpiEnvironment();
    MpiEnvironment(const MpiEnvironment&) = delete;
    MpiEnvironment& operator=(const MpiEnvironment&) = delete;

private:
    std::unique_ptr<Ranks> ranks_;
};

/// The ranks of the job that this process is one of; null where no launcher started it, or where it started
/// one process.
Ranks* job_ranks();

/// What passes messages, "Open MPI v4.1.4"; or the sentence why nothing does.
std::string mpi_library_version();

} // namespace tandem
