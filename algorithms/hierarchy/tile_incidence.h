// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "backends/lanes.h"

namespace tandem {

/// Pairs of tetrahedra of one mesh that make no self pair, by pairs of tiles. A tile is TANDEM_LANES
/// tetrahedra in the order of the device. A pair of tiles is stored once, if any two of their tetrahedra
/// share a vertex number.
struct IncidenceTable {
    std::vector<std::uint32_t> starts;   ///< by tile: its first pair, followed by the number of all pairs
    std::vector<std::uint32_t> partners; ///< by pair: the second tile, >= the first; ascending in a tile
    /// TANDEM_LANES words a pair. Bit l of word r: tetrahedron r of the first tile and l of the second share
    /// a vertex. For a tile with itself also if l <= r, so that each self pair is left in one order.
    std::vector<std::uint32_t> masks;
};

/// `tetrahedra`: four vertex numbers each. All numbers are below `vertices`.
IncidenceTable incidence_of(std::span<const std::uint32_t> tetrahedra, std::size_t vertices);

/// The tables of all meshes on a device (incidence.clh). Tiles are numbered as rows of TileShapes.
class TileIncidence {
public:
    /// Uploads the tables of the meshes of which `self` pairs a body with itself; the others have no pairs.
    /// Throws OutOfMemory.
    TileIncidence(const Bodies& bodies, SelfPairs self);

    const Buffer& starts() const { return starts_; }
    const Buffer& partners() const { return partners_; }
    const Buffer& masks() const { return masks_; }
    std::size_t bytes() const { return starts_.bytes() + partners_.bytes() + masks_.bytes(); }

private:
    Buffer starts_, partners_, masks_;
};

} // namespace tandem
