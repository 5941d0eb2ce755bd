// SPDX-License-Identifier: MIT
// What the kernels of a cell took, and what they had to.
#pragma once

#include "algorithms/cost.h"
#include "harness/profile/limits.h"
#include "harness/sampling/measurement.h"
#include "harness/sampling/statistics.h"

#include <optional>
#include <string_view>

namespace tandem::profile {

/// A kernel that takes so many times its floor is bound by none of its terms.
inline constexpr double latency_from = 3;

/// The terms of a floor, nanoseconds a frame; none where nothing is declared or the ceiling is not known.
struct Floor {
    std::optional<double> bytes, operations, launches;
    bool cached = false; ///< bytes are held against the cache: all of a frame's fit it

    /// The largest; none without any.
    std::optional<double> ns() const;
};

/// One kernel, by its entry point; of a frame.
struct KernelProfile {
    std::string entry;
    Summary ns;          ///< device time, over the rounds' instrumented replays
    KernelSample sample; ///< of the last replay, over its frames
    double launches = 0;
    double share = 0;                        ///< of the device time of all kernels
    std::optional<double> bytes, operations; ///< declared ones (algorithms/cost.h)
    std::string_view how;                    ///< what of it is declared; empty: nothing
    Floor floor;

    /// Bytes and operations a second.
    std::optional<double> bytes_per_s() const { return rate(bytes); }
    std::optional<double> operations_per_s() const { return rate(operations); }
    /// Shares of the ceilings.
    std::optional<double> of_bytes() const { return part(floor.bytes); }
    std::optional<double> of_operations() const { return part(floor.operations); }
    /// Measured over floor.
    std::optional<double> over_floor() const;
    /// "memory", "cache", "operations" or "launches": the largest term of the floor. "latency" where it takes
    /// `latency_from` times that or more and both bytes and operations are declared: its work-items wait for
    /// each other, or for data that they ask for one after the other. None otherwise: what is not declared
    /// may be what it takes.
    std::optional<std::string_view> bound() const;

private:
    std::optional<double> rate(std::optional<double> amount) const;
    std::optional<double> part(std::optional<double> term) const;
};

/// Those of all its instrumented replays, the longest first.
std::vector<KernelProfile> profile_kernels(const Measurement& measurement, const FrameFacts& facts,
                                           std::span<const KernelCost> costs, const Limits& limits);

/// The mean frame of what was measured; what it touches is the caller's to add.
FrameFacts mean_frame(const Measurement& measurement);

} // namespace tandem::profile
