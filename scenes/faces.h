// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tandem {

/// A face of a tetrahedron: its vertices in ascending order, and where it came from.
struct Face {
    std::array<std::uint32_t, 3> vertices;
    std::uint32_t tetrahedron;
    std::uint32_t corner; ///< the one opposite
};

/// The four faces of every tetrahedron, by vertices: tetrahedra that share a face have theirs side by side,
/// in no order among them.
std::vector<Face> sorted_faces(const Mesh& mesh);

} // namespace tandem
