// SPDX-License-Identifier: MIT
// Built where there is no MPI.
#include "harness/sampling/ranks/environment.h"
#include "harness/sampling/ranks/mpi_environment.h"
#include "base/error.h"

namespace tandem {

MpiEnvironment::MpiEnvironment() {
    if (has_launcher())
        throw InputError(
            "this program was started by a launcher of MPI and built without MPI: every copy would do "
            "the same; install an MPI (Debian: libopenmpi-dev, openmpi-bin) and build it again, or start "
            "it without the launcher");
}

MpiEnvironment::~MpiEnvironment() = default;

Ranks* job_ranks() { return nullptr; }

std::string mpi_library_version() { return "this program was built without MPI"; }

} // namespace tandem
