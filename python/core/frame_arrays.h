// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "python/core/given_rows.h"

#include <vector>

namespace tandem::python {

/// Arrays of one frame. Without poses every body has the identity. Deformable bodies without vertices have
/// those of their mesh.
struct FrameArrays {
    std::optional<GivenRows> poses;
    std::vector<std::uint32_t> posed{};             ///< rigid bodies of the rows of poses; empty: all bodies
    std::vector<std::optional<GivenRows>> vertices; ///< one per body, or empty

    /// The vertices of a deformable body; null: not given.
    const GivenRows* vertices_of(std::size_t body) const {
        return body < vertices.size() && vertices[body] ? &*vertices[body] : nullptr;
    }
};

/// Arrays of one call.
struct Input {
    FrameArrays frame;
    std::optional<FrameArrays> next;                   ///< the frame's successor, with motion=linear
    std::optional<std::vector<BodyPair>> body_pairs{}; ///< checked, ascending; none: the session finds them
    bool on_device = false; ///< whether kernels read some of the arrays in memory of the collider's device
    /// Whether what is left out is that of the last frame, and in `next` that of `frame`.
    bool updates = false;
};

/// Throws InputError if an array has not one row per body, or not one per vertex of its body's mesh.
void check_rows(const Scene& scene, const Input& input);

} // namespace tandem::python
