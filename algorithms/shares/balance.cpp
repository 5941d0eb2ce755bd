// SPDX-License-Identifier: MIT
#include "algorithms/shares/balance.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tandem {

namespace {

constexpr double bearable = 1.05; ///< imbalance that no deal is made for
constexpr double useful = 0.8;    ///< what a deal that was worth it leaves of the rest, at most
constexpr double sure = 2.5;      ///< standard errors
constexpr std::size_t least_patience = 4, most_patience = 256; ///< frames
constexpr std::size_t most_seen = 2 * most_patience;           ///< frames that are looked at together
constexpr double of_the_last = 0.5;                            ///< share of the newest frames in a speed

} // namespace

Balance::Balance(std::size_t shares)
    : speeds_(shares, 1.0), seen_(shares), patience_(least_patience), next_look_(least_patience) {}

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

/// Shares of a frame's mean time, so that frames which are longer than others tell as much as these.
void Balance::see(std::span<const SharedWork> done, std::span<const double> work) {
    if (wants_a_deal_ || std::exchange(is_new_, false)) return;
    double mean = 0;
    for (const auto& one : done) mean += static_cast<double>(one.ns) / static_cast<double>(done.size());
    if (!(mean > 0)) return;
    ++frames_;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        const double time = static_cast<double>(done[i].ns) / mean;
        seen_[i].sum += time;
        seen_[i].squares += time * time;
        seen_[i].work += work[i];
        seen_[i].ns += static_cast<double>(done[i].ns);
    }
    if (frames_ == next_look_) look_back();
}

/// The longest mean time over that of all, less what scatter leaves unsure of it: a share's own or, as few
/// frames tell little of that, that of all.
double Balance::sure_imbalance() const {
    const auto frames = static_cast<double>(frames_);
    const auto variance = [&](const Seen& seen) {
        return std::max(0.0, seen.squares - seen.sum * seen.sum / frames) / (frames - 1);
    };
    double of_all = 0, surely = 0;
    for (const auto& seen : seen_) of_all += variance(seen) / static_cast<double>(seen_.size());
    for (const auto& seen : seen_)
        surely =
            std::max(surely, seen.sum / frames - sure * std::sqrt(std::max(of_all, variance(seen)) / frames));
    return surely;
}

void Balance::look_back() {
    double longest = 0;
    for (std::size_t i = 0; i < seen_.size(); ++i) {
        const auto& seen = seen_[i];
        longest = std::max(longest, seen.sum / static_cast<double>(frames_));
        if (!(seen.work > 0) || !(seen.ns > 0)) continue;
        const double speed = seen.work / seen.ns;
        speeds_[i] = knows_speeds_ ? of_the_last * speed + (1 - of_the_last) * speeds_[i] : speed;
    }
    knows_speeds_ = true;
    if (std::exchange(judges_, false)) {
        const bool was_useful = longest - 1 < useful * (before_ - 1);
        patience_ = was_useful ? least_patience : std::min(2 * patience_, most_patience);
    }
    wants_a_deal_ = sure_imbalance() > bearable;
    before_ = longest;
    next_look_ = 2 * frames_;
    if (next_look_ > most_seen) begin();
}

void Balance::begin() {
    frames_ = 0;
    next_look_ = patience_;
    seen_.assign(seen_.size(), {});
}

void Balance::dealt() {
    judges_ = std::exchange(wants_a_deal_, false);
    is_new_ = true;
    begin();
}

} // namespace tandem
