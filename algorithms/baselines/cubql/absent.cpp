// SPDX-License-Identifier: MIT
// Replaces cubql_*.cpp and their dependencies if CMake finds no cuBQL or no CUDA compiler.
#include "algorithms/baselines/cubql/cubql_stages.h"

#include <stdexcept>

namespace tandem {

std::string_view cubql_absence() {
    return "this program was built without cuBQL; clone github.com/NVIDIA/cuBQL, then configure with "
           "-DCUBQL_INCLUDE_DIR=<clone> on a machine with nvcc and build again";
}

AlgorithmStages cubql_stages(const BuildContext&) {
    throw std::logic_error("cubql_stages() called in a program without cuBQL");
}

} // namespace tandem
