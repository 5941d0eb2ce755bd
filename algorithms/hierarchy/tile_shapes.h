// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"

namespace tandem {

/// What the tiles of level 0 have their tetrahedra from, which meshes have and no frame changes (tiles.clh):
/// the vertices of each 32 tetrahedra once, and four of those, a byte each, for every tetrahedron.
class TileShapes {
public:
    /// Tetrahedra of a tile.
    static constexpr std::uint32_t lanes = 32;

    /// Of the meshes of `bodies`. Throws OutOfMemory.
    explicit TileShapes(const Bodies& bodies);

    /// The row of a mesh's first tile.
    std::uint32_t first_row(std::size_t mesh) const { return first_rows_[mesh]; }
    const Buffer& starts() const { return starts_; }                 ///< a word a row, and one at the end
    const Buffer& vertex_numbers() const { return vertex_numbers_; } ///< words, of the mesh's vertices
    const Buffer& corners() const { return corners_; }               ///< a word a tetrahedron, 32 a row
    std::size_t bytes() const { return starts_.bytes() + vertex_numbers_.bytes() + corners_.bytes(); }

private:
    std::vector<std::uint32_t> first_rows_;
    Buffer starts_, vertex_numbers_, corners_;
};

} // namespace tandem
