// SPDX-License-Identifier: MIT
#include "harness/sampling/cell_sampler.h"

#include <algorithm>

namespace tandem {

std::size_t CellSampler::samples_a_round() const {
    if (state_.replay_ns <= 0) return 1;
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(state_.prepare_ns / (4 * state_.replay_ns), 1, 32));
}

} // namespace tandem
