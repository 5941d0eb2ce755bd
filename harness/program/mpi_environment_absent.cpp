// SPDX-License-Identifier: MIT
// For builds without MPI.
#include "harness/program/launcher.h"
#include "harness/program/mpi_environment.h"
#include "base/error.h"

namespace tandem {

MpiEnvironment::MpiEnvironment() {
    if (has_launcher())
        throw InputError(
            "an MPI launcher started this program, but it was built without MPI: every process would do the "
            "same work; install an MPI (Debian: libopenmpi-dev, openmpi-bin) and rebuild the program, or "
            "start it without the launcher");
}

MpiEnvironment::~MpiEnvironment() = default;

Ranks* job_ranks() { return nullptr; }

std::string mpi_library_version() { return "this program was built without MPI"; }

} // namespace tandem
