// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace tandem {

/// A named counter of an algorithm's work.
struct Counter {
    /// How the values of several frames make one: their sum, or the value of the last.
    enum class Total { sum, last };

    std::string_view name;    ///< key in FrameResult::work and in records
    std::string_view unit;    ///< "bytes", or the things that are counted
    std::string_view meaning; ///< one line
    Total total = Total::sum; ///< over frames
};

/// Counters of all walks that use emit.clh.
namespace counters {
inline constexpr Counter bvtt_nodes{"bvtt_nodes", "node pairs", "node pairs tested"};
inline constexpr Counter seeds{"seeds", "node pairs", "node pairs from which walks start"};
} // namespace counters

} // namespace tandem
