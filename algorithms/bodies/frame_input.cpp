// SPDX-License-Identifier: MIT
#include "algorithms/bodies/frame_input.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace tandem {

void check_successor(const Frame& frame, const Frame& next) {
    if (frame.poses.size() != next.poses.size() || frame.deformed.size() != next.deformed.size())
        throw InputError(fmt::format("the frame has {} bodies and its successor has {}; motion=linear needs "
                                     "the same bodies in both",
                                     frame.poses.size(), next.poses.size()));
    for (std::size_t body = 0; body < frame.deformed.size(); ++body)
        if (frame.deformed[body].size() != next.deformed[body].size())
            throw InputError(fmt::format("body {} has {} vertices in the frame and {} in its successor; "
                                         "motion=linear needs the same vertices in both",
                                         body, frame.deformed[body].size(), next.deformed[body].size()));
}

std::vector<std::vector<std::uint32_t>>
skipped_in_either(const std::vector<std::vector<std::uint32_t>>& frame,
                  const std::vector<std::vector<std::uint32_t>>& next) {
    if (next.empty()) return frame;
    if (frame.empty()) return next;
    std::vector<std::vector<std::uint32_t>> either(frame.size());
    for (std::size_t body = 0; body < frame.size(); ++body)
        std::ranges::set_union(frame[body], next[body], std::back_inserter(either[body]));
    return either;
}

} // namespace tandem
