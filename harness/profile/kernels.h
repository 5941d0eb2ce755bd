// SPDX-License-Identifier: MIT
// The time that the kernels of a cell took, and the floor below which they cannot get.
#pragma once

#include "algorithms/bodies/cost.h"
#include "harness/profile/limits.h"
#include "harness/sampling/measurement.h"
#include "base/statistics.h"

#include <optional>
#include <string_view>

namespace tandem::profile {

/// From this multiple of its floor on, no term of the floor limits a kernel.
inline constexpr double latency_from = 3;

/// The terms of a floor in nanoseconds a frame. None when nothing is declared or the ceiling is unknown.
struct Floor {
    std::optional<double> bytes, operations, launches;
    bool cached = false; ///< the bytes of a frame fit the cache, so its rate is the ceiling

    /// The largest term; none without any.
    std::optional<double> ns() const;
};

/// The profile of one kernel, by its entry point. Numbers are for one frame.
struct KernelProfile {
    std::string entry;
    Summary ns;          ///< device time over the instrumented replays of all rounds
    KernelSample sample; ///< sum over the frames of the last replay
    double launches = 0;
    double time_fraction = 0;                ///< fraction of the device time of all kernels
    std::optional<double> bytes, operations; ///< declared costs (algorithms/bodies/cost.h)
    std::string_view how;                    ///< how the declared costs are counted; empty: none declared
    Floor floor;

    /// Bytes and operations a second.
    std::optional<double> bytes_per_s() const { return rate(bytes); }
    std::optional<double> operations_per_s() const { return rate(operations); }
    /// Fractions of the ceilings.
    std::optional<double> of_bytes() const { return fraction(floor.bytes); }
    std::optional<double> of_operations() const { return fraction(floor.operations); }
    /// Measured time divided by the floor.
    std::optional<double> over_floor() const;
    /// The largest term of the floor: "memory", "cache", "operations" or "launches". "latency" when the time
    /// is at least `latency_from` times the floor and both bytes and operations are declared: work-items then
    /// wait for each other, or for dependent loads. None otherwise, because undeclared work may take the
    /// time.
    std::optional<std::string_view> bound() const;

private:
    std::optional<double> rate(std::optional<double> amount) const;
    std::optional<double> fraction(std::optional<double> term) const;
};

/// The kernels of all instrumented replays, the longest first.
std::vector<KernelProfile> profile_kernels(const Measurement& measurement, const FrameFacts& facts,
                                           std::span<const KernelCost> costs, const Limits& limits);

} // namespace tandem::profile
