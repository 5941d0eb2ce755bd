// SPDX-License-Identifier: MIT
#include "harness/program/launcher.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <unistd.h>

namespace tandem {

bool has_launcher() {
    // Open MPI's mpirun; PMI launchers of MPICH, Intel and Slurm; launchers with PMIx.
    constexpr std::array names{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"};
    return std::ranges::any_of(names, [](const char* name) { return std::getenv(name) != nullptr; });
}

int tasks_without_mpi() {
    const char* tasks = has_launcher() ? nullptr : std::getenv("SLURM_STEP_NUM_TASKS");
    return tasks != nullptr ? std::max(std::atoi(tasks), 1) : 1;
}

std::vector<char*> environment_without_launcher() {
    using namespace std::string_view_literals;
    constexpr std::array beginnings{"OMPI_"sv, "PMIX_"sv, "PMI_"sv, "PMI2_"sv, "HYDRA_"sv, "MPIR_"sv};
    std::vector<char*> kept;
    for (char** variable = environ; *variable != nullptr; ++variable)
        if (std::ranges::none_of(beginnings,
                                 [&](auto begin) { return std::string_view(*variable).starts_with(begin); }))
            kept.push_back(*variable);
    kept.push_back(nullptr);
    return kept;
}

} // namespace tandem
