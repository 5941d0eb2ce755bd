// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "algorithms/broad_phase/broad.cl.h"
#include "algorithms/bodies/subdomain.h"
#include "algorithms/bodies/build_context.h"

namespace tandem {

/// Finds body pairs on the device: all pairs (a < b) that may meet and whose root k-DOPs overlap after the
/// last refit, and the pairs (a, a) of setting self. Grids depend on the number of bodies only.
class BroadStage {
public:
    /// `volumes`: a k-DOP per body (volume.clh). `bodies` must outlive this. Throws InputError if there are
    /// too many bodies to number the pairs of their tiles.
    BroadStage(const Bodies& bodies, const Buffer& volumes, LaunchShape shape,
               SelfPairs self = SelfPairs::off);

    /// Sorts the bodies by their positions in `frame`. The order affects the speed of later searches, which
    /// is high if spatial neighbours are close in it, but not the pairs.
    void sort(const Frame& frame);
    /// From the next launch on, finds the pairs of a subdomain, and has its order of bodies.
    void set_subdomain(const Subdomain& subdomain);
    /// Sorts the bodies by their volumes, for frames in the device's memory. Waits for it.
    void sort_by_volumes();
    /// Enqueues the search. It writes pairs of 2 words to `pairs`, in any order and up to `capacity`, and
    /// adds their number to `status`, which the caller has cleared.
    void launch(const Buffer& pairs, std::uint32_t capacity, const Buffer& status);
    /// Upper bound on the number of pairs.
    std::uint64_t most_pairs() const;

private:
    std::vector<Eigen::Vector3d> centres(const Frame& frame) const;
    void upload(std::vector<std::uint32_t> order);
    void list_tile_pairs(const std::vector<std::uint32_t>& order);
    template<class Real>
    std::vector<Eigen::Vector3d> centres_of_volumes() const;
    void sort(const std::vector<Eigen::Vector3d>& centres);

    const Bodies& bodies_;
    Buffer volumes_;
    SelfPairs self_;
    LaunchShape shape_;
    std::uint32_t count_ = 0;        ///< bodies in the order
    std::uint32_t moving_count_ = 0; ///< moving bodies, which are first in it; every pair has one
    std::vector<Eigen::Vector3d> mesh_centres_;
    Buffer order_, roots_, unions_, filters_;
    Buffer list_; ///< pairs of tiles that have bodies of one world; unused in a scene of one world
    std::uint32_t listed_ = 0;                   ///< their number
    KernelOf<kernels::broad::BoundTiles> bound_; ///< null for a single tile
    KernelOf<kernels::broad::FindBodyPairs> find_;
};

} // namespace tandem
