// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/hierarchy/tile_trees.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Decides on the device, in every frame, whether a list is still valid: compares how far bodies have moved
/// since the frame of the list with the list's pad. Has the state that lasts from frame to frame, and the
/// bounds of tiles and bodies enlarged by the pad.
class BodyMotion {
public:
    /// `pad`: the largest pad, in thousandths of the mean length of a tetrahedron's bounding box. `trees`
    /// must outlive this. Throws OutOfMemory.
    BodyMotion(const TileTrees& trees, LaunchShape shape, std::int64_t pad);

    /// Compiles the kernels for the output of a walk.
    void compile(Output output);
    /// Enqueues the comparison. `request`: REQUEST_... (list_state.clh). `given`: the walk begins with the
    /// body pairs of the frame, whose number is in `status`, and not with those of a search.
    void decide(std::uint32_t request, bool given, const Buffer& status) const;
    /// Enqueues the bounds of the walk that decide() has chosen.
    void pad_bounds() const;

    const Buffer& pads() const { return pads_; }     ///< PADS reals, descending
    const Buffer& state() const { return state_; }   ///< STATE_WORDS words
    const Buffer& walked() const { return walked_; } ///< status of the walk: STATUS_WORDS words
    const Buffer& volumes() const { return padded_volumes_; }
    const Buffer& roots() const { return padded_roots_; }
    const Buffer& uppers() const { return padded_uppers_; }
    const Buffer& saved_poses() const { return saved_poses_; }
    const Buffer& saved_vertices() const { return saved_vertices_; }
    std::uint32_t pose_rows() const;   ///< rows of 4 reals
    std::uint32_t vertex_rows() const; ///< of deformable bodies
    std::uint32_t first_vertex() const { return first_vertex_; }

private:
    void upload_shapes();
    void upload_pads(std::int64_t pad);
    Grid grid(std::uint64_t items) const;

    const TileTrees& trees_;
    Device& device_;
    LaunchShape shape_;
    std::uint32_t first_vertex_ = 0; ///< of deformable bodies, in the table of vertices
    Buffer shapes_, pads_, state_, walked_, saved_poses_, saved_vertices_;
    Buffer padded_volumes_, padded_roots_, padded_uppers_;
    Kernel measure_, decide_, pad_;
};

} // namespace tandem
