// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tandem {

/// A face of a tetrahedron: its vertices in the topology in ascending order, and its source.
struct Face {
    std::array<std::uint32_t, 3> vertices;
    std::uint32_t tetrahedron;
    std::uint32_t corner; ///< the opposite corner of the tetrahedron
};

/// The four faces of every tetrahedron, sorted by vertices. Copies of a shared face are adjacent, in
/// unspecified order.
std::vector<Face> sorted_faces(const Mesh& mesh);

} // namespace tandem
