// SPDX-License-Identifier: MIT
#include "algorithms/distributed/load_balancer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tandem {

namespace {

constexpr double tolerated_imbalance = 1.05; ///< no repartition up to this value
constexpr double max_remaining = 0.8; ///< fraction of the excess imbalance that a useful repartition leaves
/// A difference of speeds that is significant. Several devices are tested many times, hence a high value.
constexpr double standard_errors = 4;
/// Prior for the deviation of a device's speed between frames, and its weight in frames.
constexpr double prior_deviation = 0.1, prior_frames = 4;
constexpr std::size_t min_interval = 4, max_interval = 256; ///< frames between evaluations
constexpr std::size_t max_sampled = 2 * max_interval;       ///< frames in one set of samples

} // namespace

LoadBalancer::LoadBalancer(std::size_t subdomains)
    : speeds_(subdomains, 1.0),
      samples_(subdomains),
      interval_(min_interval),
      next_evaluation_(min_interval) {}

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

/// Normalises speeds by the frame's total, so that frames that are slow as a whole have the same weight.
void LoadBalancer::add_sample(std::span<const DeviceWork> done, std::span<const double> work) {
    if (should_repartition_) return;
    if (std::exchange(is_first_frame_, false)) {
        previous_imbalance_ = expected_imbalance(work);
        should_repartition_ = previous_imbalance_ > tolerated_imbalance;
    }
    if (std::exchange(is_new_partition_, false)) return;
    std::vector<double> measured(samples_.size());
    double total_measured = 0, total_estimated = 0; // of devices with work; the rest keep their speeds
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        if (!(work[i] > 0) || done[i].ns <= 0) continue;
        measured[i] = work[i] / static_cast<double>(done[i].ns);
        total_measured += measured[i];
        total_estimated += speeds_[i];
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        auto& samples = samples_[i];
        samples.work += work[i];
        if (!(measured[i] > 0)) continue;
        const double speed = measured[i] / total_measured * total_estimated;
        samples.sum += speed;
        samples.squares += speed * speed;
        ++samples.frames;
    }
    if (++frames_ == next_evaluation_) evaluate();
}

/// Standard deviation of a device's speed between frames, divided by its mean. It is pooled over all devices,
/// because the samples of one are few, and the prior counts as `prior_frames` frames.
double LoadBalancer::relative_deviation() const {
    double squares = prior_frames * prior_deviation * prior_deviation, frames = prior_frames;
    for (const auto& samples : samples_) {
        if (samples.frames < 2) continue;
        const double mean = samples.sum / samples.frames;
        squares += std::max(0.0, samples.squares / (mean * mean) - samples.frames);
        frames += samples.frames - 1;
    }
    return std::sqrt(squares / frames);
}

/// Replaces the speed of a device only if its mean over the frames differs significantly.
void LoadBalancer::estimate_speeds() {
    const double error = standard_errors * relative_deviation();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const auto& samples = samples_[i];
        if (samples.frames < 1) continue;
        const double measured = samples.sum / samples.frames;
        if (std::abs(measured - speeds_[i])
            > error / std::sqrt(samples.frames) * std::max(measured, speeds_[i]))
            speeds_[i] = measured;
    }
}

void LoadBalancer::evaluate() {
    estimate_speeds();
    std::vector<double> work;
    for (const auto& samples : samples_) work.push_back(samples.work);
    const double expected = expected_imbalance(work);
    if (std::exchange(evaluates_repartition_, false)) {
        const bool was_useful = expected - 1 < max_remaining * (previous_imbalance_ - 1);
        interval_ = was_useful ? min_interval : std::min(2 * interval_, max_interval);
    }
    should_repartition_ = expected > tolerated_imbalance;
    previous_imbalance_ = expected;
    next_evaluation_ = 2 * frames_;
    if (next_evaluation_ > max_sampled) restart();
}

void LoadBalancer::restart() {
    frames_ = 0;
    next_evaluation_ = interval_;
    samples_.assign(samples_.size(), {});
}

void LoadBalancer::repartitioned() {
    evaluates_repartition_ = std::exchange(should_repartition_, false);
    is_new_partition_ = true;
    restart();
}

} // namespace tandem
