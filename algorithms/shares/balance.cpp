// SPDX-License-Identifier: MIT
#include "algorithms/shares/balance.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr double bearable = 1.05; ///< imbalance that no deal is made for
constexpr double useful = 0.8;    ///< what a deal that was worth it leaves of the rest, at most
constexpr std::size_t most_patience = 256;
constexpr double of_the_last = 0.5; ///< share of the newest frame in a speed

} // namespace

double imbalance(std::span<const SharedWork> done) {
    std::int64_t longest = 0, sum = 0;
    for (const auto& work : done) {
        longest = std::max(longest, work.ns);
        sum += work.ns;
    }
    return sum == 0
               ? 1
               : static_cast<double>(longest) * static_cast<double>(done.size()) / static_cast<double>(sum);
}

void Balance::see(std::span<const SharedWork> done, std::span<const double> work) {
    if (frames_++ == 0) return;
    for (std::size_t i = 0; i < speeds_.size(); ++i) {
        if (!(work[i] > 0) || done[i].ns <= 0) continue;
        const double speed = work[i] / static_cast<double>(done[i].ns);
        speeds_[i] = frames_ == 2 ? speed : of_the_last * speed + (1 - of_the_last) * speeds_[i];
    }
    const double now = imbalance(done);
    if (judges_) {
        const bool was_useful = now - 1 < useful * (before_ - 1);
        patience_ = was_useful ? 2 : std::min(2 * patience_, most_patience);
        judges_ = false;
    }
    waited_ = now > bearable ? waited_ + 1 : 0;
    wants_a_deal_ = waited_ >= patience_;
    if (wants_a_deal_) before_ = now;
}

void Balance::dealt() {
    judges_ = wants_a_deal_;
    wants_a_deal_ = false;
    waited_ = 0;
}

} // namespace tandem
