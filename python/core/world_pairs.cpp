// SPDX-License-Identifier: MIT
#include "python/core/world_pairs.h"

#include "algorithms/bodies/self_pairs.h"
#include "algorithms/broad_phase/slab_sweep.h"
#include "base/parallel.h"

#include <algorithm>

namespace tandem::python {

namespace {

/// The axis along which lower ends of the slabs spread most, of those that any mesh has.
std::size_t widest_axis(const std::vector<double>& slabs, std::size_t axes) {
    std::size_t widest = 0;
    double most = -1;
    for (std::size_t axis = 0; axis < axes; ++axis) {
        double least = slabs[2 * axis], greatest = least;
        for (std::size_t i = 2 * axis; i < slabs.size(); i += 2 * axes) {
            least = std::min(least, slabs[i]);
            greatest = std::max(greatest, slabs[i]);
        }
        if (greatest - least <= most) continue;
        most = greatest - least;
        widest = axis;
    }
    return widest;
}

} // namespace

WorldPairs::WorldPairs(const Scene& scene, const Geometry& geometry, Broad broad, SelfPairs self,
                       std::size_t worlds)
    : scene_(scene),
      sweep_(scene, geometry, broad == Broad::device ? Broad::tight : broad, self),
      self_(self),
      worlds_(worlds),
      bodies_(static_cast<std::uint32_t>(scene.bodies.size() / worlds)) {}

std::vector<BodyPair> WorldPairs::pairs(const FrameInput& input) const {
    std::vector<std::vector<BodyPair>> found(worlds_);
    parallel_for(worlds_, [&](std::size_t world) {
        found[world] = pairs_of(input, static_cast<std::uint32_t>(world) * bodies_);
    });
    std::vector<BodyPair> all;
    for (const auto& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
    return all;
}

/// Pairs of the world whose first body is `first`.
std::vector<BodyPair> WorldPairs::pairs_of(const FrameInput& input, std::uint32_t first) const {
    const auto axes = sweep_.axes();
    std::vector<double> slabs(bodies_ * 2 * axes);
    for (std::uint32_t body = 0; body < bodies_; ++body)
        sweep_.bound(input, first + body, 0, &slabs[body * 2 * axes]);
    std::vector<BodyPair> pairs;
    for (const auto& [a, b] : overlapping(slabs, axes, widest_axis(slabs, axes)))
        if (may_meet(scene_, first + a, first + b)) pairs.push_back({first + a, first + b});
    for (auto body = first; body < first + bodies_; ++body)
        if (meets_itself(scene_, body, self_)) pairs.push_back({body, body});
    std::ranges::sort(pairs);
    return pairs;
}

} // namespace tandem::python
