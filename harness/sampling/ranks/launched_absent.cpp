// SPDX-License-Identifier: MIT
// Built where there is no MPI.
#include "harness/sampling/ranks/environment.h"
#include "harness/sampling/ranks/launched.h"
#include "base/error.h"

namespace tandem {

Launched::Launched() {
    if (has_launcher())
        throw InputError(
            "this program was started by a launcher of MPI and built without MPI: every copy would do "
            "the same; install an MPI (Debian: libopenmpi-dev, openmpi-bin) and build it again, or start "
            "it without the launcher");
}

Launched::~Launched() = default;

Ranks* launched_ranks() { return nullptr; }

std::string launched_by() { return "this program was built without MPI"; }

} // namespace tandem
