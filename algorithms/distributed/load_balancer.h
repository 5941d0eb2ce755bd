// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"

#include <span>

namespace tandem {

/// Estimates the speeds of the devices of a session, and decides when a repartition would shorten frames.
class LoadBalancer {
public:
    explicit LoadBalancer(std::size_t subdomains);

    /// Adds a frame: what each device did, and its work as Partitioner::work_of counts it. Times of the first
    /// frame after each partition are ignored, because devices may compile or allocate in it.
    void add_sample(std::span<const DeviceWork> done, std::span<const double> work);
    /// Whether a repartition pays, because one device needs much longer than the average of all devices. The
    /// decision is made after the first frame and again after some frames. The number of frames doubles after
    /// a repartition that did not help.
    bool should_repartition() const { return should_repartition_; }
    /// Starts new samples; called after each repartition.
    void repartitioned();
    /// Relative speed of each device, as work per time. Equal until the samples show a significant
    /// difference.
    std::span<const double> speeds() const { return speeds_; }

private:
    /// Samples of one device over some frames.
    struct SpeedSamples {
        double sum = 0, squares = 0; ///< of its speeds
        double frames = 0;           ///< in which it had work
        double work = 0;
    };

    double expected_imbalance(std::span<const double> work) const;
    double relative_deviation() const;
    void estimate_speeds();
    void evaluate();
    void restart();

    std::vector<double> speeds_;
    std::vector<SpeedSamples> samples_;
    std::size_t frames_ = 0;       ///< in samples_
    std::size_t interval_;         ///< frames
    std::size_t next_evaluation_;  ///< value of frames_ at which evaluate() runs
    bool is_first_frame_ = true;   ///< no frame has been added
    bool is_new_partition_ = true; ///< no frame of this partition has been added
    bool should_repartition_ = false;
    bool evaluates_repartition_ = false; ///< the current samples show whether the last repartition helped
    double previous_imbalance_ = 1;      ///< the imbalance that caused it
};

/// The longest time of a device divided by the mean of all: 1 when all devices finish together.
double imbalance(std::span<const DeviceWork> done);

} // namespace tandem
