// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"

#include <span>

namespace tandem {

/// How fast devices that share frames are, and whether a new deal would make frames shorter.
class LoadBalancer {
public:
    explicit LoadBalancer(std::size_t subdomains);

    /// A frame: what each device did, and its work as deals count it. Times of the first one, and of the
    /// first after a deal, say nothing: some devices compile in them, or make room.
    void add_sample(std::span<const DeviceWork> done, std::span<const double> work);
    /// Whether, at these speeds, one device's work takes so much longer than all on average that bodies had
    /// better be dealt anew: asked of the first frame of all, and after some frames again. After a deal that
    /// was of no use it takes twice as many.
    bool should_repartition() const { return should_repartition_; }
    /// Bodies have been dealt anew.
    void repartitioned();
    /// Of each device, beside the others: work done in a time; equal until frames, beside their scatter, say
    /// for sure that they are not.
    std::span<const double> speeds() const { return speeds_; }

private:
    /// Of one device over some frames.
    struct SpeedSamples {
        double sum = 0, squares = 0; ///< of its speeds
        double frames = 0;           ///< with work
        double work = 0;
    };

    double expected_imbalance(std::span<const double> work) const;
    double scatter() const;
    void estimate_speeds();
    void evaluate();
    void begin();

    std::vector<double> speeds_;
    std::vector<SpeedSamples> samples_;
    std::size_t frames_ = 0;      ///< in samples_
    std::size_t patience_;        ///< frames
    std::size_t next_evaluation_; ///< at frames_
    bool is_first_ = true;        ///< no frame at all has been seen
    bool is_new_ = true;          ///< no frame of this deal has been seen
    bool should_repartition_ = false;
    bool judges_last_partition_ = false; ///< the frames at hand tell what the last deal was good for
    double before_ = 1;                  ///< the imbalance that it was made for
};

/// The longest time over the mean of all: 1 where all devices end together.
double imbalance(std::span<const DeviceWork> done);

} // namespace tandem
