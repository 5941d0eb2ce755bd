// SPDX-License-Identifier: MIT
#include "algorithms/distributed/load_balancer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tandem {

namespace {

constexpr double bearable = 1.05; ///< imbalance that no deal is made for
constexpr double useful = 0.8;    ///< what a deal that was worth it leaves of the rest, at most
constexpr double sure = 4;        ///< standard errors: several devices are looked at many times
/// Of a device's time between frames, and how many frames it takes to know better.
constexpr double usual_scatter = 0.1, believed = 4;
constexpr std::size_t least_patience = 4, most_patience = 256; ///< frames
constexpr std::size_t most_sampled = 2 * most_patience;        ///< frames that are looked at together

} // namespace

LoadBalancer::LoadBalancer(std::size_t subdomains)
    : speeds_(subdomains, 1.0),
      samples_(subdomains),
      patience_(least_patience),
      next_evaluation_(least_patience) {}

double imbalance(std::span<const DeviceWork> done) {
    std::int64_t longest = 0, sum = 0;
    for (const auto& work : done) {
        longest = std::max(longest, work.ns);
        sum += work.ns;
    }
    return sum == 0
               ? 1
               : static_cast<double>(longest) * static_cast<double>(done.size()) / static_cast<double>(sum);
}

double LoadBalancer::expected_imbalance(std::span<const double> work) const {
    double longest = 0, sum = 0;
    for (std::size_t i = 0; i < work.size(); ++i) {
        longest = std::max(longest, work[i] / speeds_[i]);
        sum += work[i] / speeds_[i];
    }
    return sum > 0 ? longest * static_cast<double>(work.size()) / sum : 1;
}

/// Speeds in shares of the frame's, so that frames in which everything takes longer tell as much as others.
void LoadBalancer::add_sample(std::span<const DeviceWork> done, std::span<const double> work) {
    if (should_repartition_) return;
    if (std::exchange(is_first_, false)) {
        before_ = expected_imbalance(work);
        should_repartition_ = before_ > bearable;
    }
    if (std::exchange(is_new_, false)) return;
    std::vector<double> found(samples_.size());
    double all_found = 0, all_believed = 0; // of devices with work: others are as fast as they were
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        if (!(work[i] > 0) || done[i].ns <= 0) continue;
        found[i] = work[i] / static_cast<double>(done[i].ns);
        all_found += found[i];
        all_believed += speeds_[i];
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        auto& samples = samples_[i];
        samples.work += work[i];
        if (!(found[i] > 0)) continue;
        const double speed = found[i] / all_found * all_believed;
        samples.sum += speed;
        samples.squares += speed * speed;
        ++samples.frames;
    }
    if (++frames_ == next_evaluation_) evaluate();
}

/// Of a device's speed from frame to frame: standard deviation over its mean, of all devices together, as few
/// frames tell little of one; what is usual counts as some frames.
double LoadBalancer::scatter() const {
    double squares = believed * usual_scatter * usual_scatter, frames = believed;
    for (const auto& samples : samples_) {
        if (samples.frames < 2) continue;
        const double mean = samples.sum / samples.frames;
        squares += std::max(0.0, samples.squares / (mean * mean) - samples.frames);
        frames += samples.frames - 1;
    }
    return std::sqrt(squares / frames);
}

/// A device keeps its speed unless its mean over the frames is surely another.
void LoadBalancer::estimate_speeds() {
    const double error = sure * scatter();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const auto& samples = samples_[i];
        if (samples.frames < 1) continue;
        const double found = samples.sum / samples.frames;
        if (std::abs(found - speeds_[i]) > error / std::sqrt(samples.frames) * std::max(found, speeds_[i]))
            speeds_[i] = found;
    }
}

void LoadBalancer::evaluate() {
    estimate_speeds();
    std::vector<double> work;
    for (const auto& samples : samples_) work.push_back(samples.work);
    const double expected = expected_imbalance(work);
    if (std::exchange(judges_last_partition_, false)) {
        const bool was_useful = expected - 1 < useful * (before_ - 1);
        patience_ = was_useful ? least_patience : std::min(2 * patience_, most_patience);
    }
    should_repartition_ = expected > bearable;
    before_ = expected;
    next_evaluation_ = 2 * frames_;
    if (next_evaluation_ > most_sampled) begin();
}

void LoadBalancer::begin() {
    frames_ = 0;
    next_evaluation_ = patience_;
    samples_.assign(samples_.size(), {});
}

void LoadBalancer::repartitioned() {
    judges_last_partition_ = std::exchange(should_repartition_, false);
    is_new_ = true;
    begin();
}

} // namespace tandem
