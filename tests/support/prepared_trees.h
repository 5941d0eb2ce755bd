// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/hierarchy/chunk_trees.h"

namespace tandem::support {

/// A scene's bodies and their chunk trees on a device, without a session.
struct PreparedTrees {
    PreparedTrees(Device& device, const Scene& scene, const Geometry& geometry, std::uint32_t leaves,
                  std::uint32_t group_size, Bodies::Sharing sharing = Bodies::Sharing::by_mesh)
        : bodies(device, scene, geometry, sharing), trees(bodies, leaves, group_size) {}

    void update(const Frame& frame) {
        bodies.update(frame);
        trees.refit(frame);
    }
    /// All nodes after the last refit, and all body volumes.
    template<class Real>
    std::vector<Real> nodes() const {
        return reals<Real>(trees.nodes(), trees.slots());
    }
    template<class Real>
    std::vector<Real> volumes() const {
        return reals<Real>(trees.volumes(), bodies.count());
    }
    const Geometry& geometry() const { return bodies.geometry(); }

    Bodies bodies;
    ChunkTrees trees;

private:
    template<class Real>
    std::vector<Real> reals(const Buffer& from, std::uint64_t count) const {
        std::vector<Real> values(count * static_cast<std::size_t>(geometry().k));
        const StageScope scope(bodies.device(), Stage::read);
        bodies.device().download(from, std::as_writable_bytes(std::span(values)));
        return values;
    }
};

} // namespace tandem::support
