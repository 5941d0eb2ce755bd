// SPDX-License-Identifier: MIT
// Instead of embree_stages.cpp and what it needs, where CMake has found no Embree.
#include "algorithms/baselines/embree/embree_stages.h"

#include <stdexcept>

namespace tandem {

std::string_view embree_absence() {
    return "this program was built without Embree 3; install Debian's libembree-dev (scripts/setup does), "
           "then "
           "configure and build again";
}

AlgorithmStages embree_stages(const BuildContext&) {
    throw std::logic_error("embree_steps() of a program without Embree");
}

} // namespace tandem
