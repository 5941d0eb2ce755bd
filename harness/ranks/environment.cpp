// SPDX-License-Identifier: MIT
#include "harness/ranks/environment.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace tandem {

bool has_launcher() {
    // Open MPI's mpirun; PMI of MPICH's, Intel's and Slurm's; PMIx of the others.
    constexpr std::array names{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"};
    return std::ranges::any_of(names, [](const char* name) { return std::getenv(name) != nullptr; });
}

} // namespace tandem
