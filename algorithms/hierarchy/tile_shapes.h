// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "backends/lanes.h"

namespace tandem {

/// Static tables of the tiles of level 0, by mesh (tiles.clh): the distinct vertices of every 32 tetrahedra,
/// and four byte indices into these for every tetrahedron.
class TileShapes {
public:
    /// Tetrahedra per tile.
    static constexpr std::uint32_t lanes = TANDEM_LANES;

    /// Uploads the tables of the meshes of `bodies`. Throws OutOfMemory.
    explicit TileShapes(const Bodies& bodies);

    /// The row of a mesh's first tile.
    std::uint32_t first_row(std::size_t mesh) const { return first_rows_[mesh]; }
    const Buffer& starts() const { return starts_; } ///< one word per row, and a final one
    const Buffer& vertex_numbers() const {
        return vertex_numbers_;
    }                                                  ///< vertex numbers within the mesh, one word each
    const Buffer& corners() const { return corners_; } ///< one word per tetrahedron, 32 per row
    std::size_t bytes() const { return starts_.bytes() + vertex_numbers_.bytes() + corners_.bytes(); }

private:
    std::vector<std::uint32_t> first_rows_;
    Buffer starts_, vertex_numbers_, corners_;
};

} // namespace tandem
