// SPDX-License-Identifier: MIT
#include "harness/sampling/cell_sampler.h"

#include "harness/program/interrupt.h"

#include <algorithm>

namespace tandem {

void CellSampler::check(const CheckOptions& options) {
    try {
        do_check(options);
    } catch (const Interrupted&) {
        const auto rounds = state_.rounds;
        state_ = {};
        state_.rounds = rounds;
        state_.measurement.settings = cell_.settings;
        throw;
    }
}

void CellSampler::round(std::size_t samples) {
    try {
        do_round(samples);
    } catch (const Interrupted&) {
        drop_round();
        throw;
    }
}

/// Removes what a round that did not end has stored: samples, and conditions when it stopped in its
/// breakdown.
void CellSampler::drop_round() {
    const auto is_of_it = [&](const auto& item) { return item.round >= state_.rounds; };
    std::erase_if(state_.measurement.samples, is_of_it);
    std::erase_if(state_.measurement.conditions, is_of_it);
}

std::size_t CellSampler::samples_a_round() const {
    if (state_.replay_ns <= 0) return 1;
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(state_.prepare_ns / (4 * state_.replay_ns), 1, 32));
}

} // namespace tandem
