// SPDX-License-Identifier: MIT
// Replaces embree_stages.cpp and its dependencies if CMake finds no Embree.
#include "algorithms/baselines/embree/embree_stages.h"

#include <stdexcept>

namespace tandem {

std::string_view embree_absence() {
    return "this program was built without Embree; install Debian's libembree-dev (scripts/setup does), "
           "then configure and build again";
}

AlgorithmStages embree_stages(const BuildContext&) {
    throw std::logic_error("embree_stages() called in a program without Embree");
}

} // namespace tandem
