// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/hierarchy/hierarchy.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Finds body pairs on the device: all pairs (a < b) whose root k-DOPs, as refit has just left them, overlap,
/// but those of two fixed bodies. Grids depend on the number of bodies only.
class BroadStage {
public:
    /// Pairs of `bodies` by the volumes of `hierarchy`. Throws InputError for more bodies than pairs of tiles
    /// can be numbered for.
    BroadStage(const Bodies& bodies, const Hierarchy& hierarchy, LaunchShape shape);

    /// Puts the bodies in order of where `frame` has them. Neighbours in space should be neighbours there
    /// whenever pairs are sought: that decides how fast they are found, never which.
    void sort(const Frame& frame);
    /// From now on finds the pairs of a share, in whose order bodies stand.
    void take(const Subdomain& share);
    /// The same of where the last refit has left the bodies' volumes, for frames that the host does not have;
    /// waits for it.
    void sort_by_volumes();
    /// Enqueues the search. Pairs go to `pairs`, 2 words each, in no order, as far as its `capacity` reaches;
    /// their number goes to `status`, which has been cleared.
    void launch(const Buffer& pairs, std::uint32_t capacity, const Buffer& status);
    /// Of these bodies there are no more pairs than that.
    std::uint64_t most_pairs() const;

private:
    std::vector<Eigen::Vector3d> centres(const Frame& frame) const;
    void upload(const std::vector<std::uint32_t>& order);
    template<class Real>
    std::vector<Eigen::Vector3d> centres_of_volumes() const;
    void sort(const std::vector<Eigen::Vector3d>& centres);

    const Bodies& bodies_;
    const Hierarchy& hierarchy_;
    LaunchShape shape_;
    std::uint32_t count_ = 0;        ///< bodies in the order
    std::uint32_t moving_count_ = 0; ///< of these the first, one of which every pair has: that are not fixed
    std::vector<Eigen::Vector3d> mesh_centres_;
    Buffer order_, roots_, unions_;
    Kernel bound_, find_;
};

} // namespace tandem
