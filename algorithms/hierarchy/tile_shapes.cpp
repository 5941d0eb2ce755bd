// SPDX-License-Identifier: MIT
#include "algorithms/hierarchy/tile_shapes.h"

#include "backends/upload.h"

#include <algorithm>

namespace tandem {

namespace {

/// Tables of all meshes, row after row.
struct Tables {
    std::vector<std::uint32_t> starts, vertex_numbers, corners;

    /// Adds a tile: the tetrahedra `first`..`end` - 1 of a mesh.
    void add(const OrderedMesh& mesh, std::size_t first, std::size_t end) {
        const std::span given(mesh.tetrahedra.data() + 4 * first, 4 * (end - first));
        std::vector<std::uint32_t> own(given.begin(), given.end());
        std::sort(own.begin(), own.end()); // adjacent work-items read adjacent vertices
        own.erase(std::unique(own.begin(), own.end()), own.end());
        starts.push_back(static_cast<std::uint32_t>(vertex_numbers.size()));
        vertex_numbers.insert(vertex_numbers.end(), own.begin(), own.end());
        for (std::size_t t = 0; t < TileShapes::lanes; ++t) {
            std::uint32_t word = 0;
            for (std::size_t corner = 0; corner < 4 && first + t < end; ++corner) {
                const auto at = std::lower_bound(own.begin(), own.end(), given[4 * t + corner]) - own.begin();
                word |= static_cast<std::uint32_t>(at) << 8 * corner;
            }
            corners.push_back(word);
        }
    }
};

} // namespace

TileShapes::TileShapes(const Bodies& bodies) {
    Tables tables;
    for (std::size_t mesh = 0; mesh < bodies.scene().meshes.size(); ++mesh) {
        const auto& ordered = bodies.ordered_mesh(mesh);
        first_rows_.push_back(static_cast<std::uint32_t>(tables.starts.size()));
        for (std::size_t first = 0; first < ordered.ids.size(); first += lanes)
            tables.add(ordered, first, std::min<std::size_t>(first + lanes, ordered.ids.size()));
    }
    tables.starts.push_back(static_cast<std::uint32_t>(tables.vertex_numbers.size()));
    starts_ = uploaded(bodies.device(), bytes_of(tables.starts), "vertices of tiles, starts");
    vertex_numbers_ = uploaded(bodies.device(), bytes_of(tables.vertex_numbers), "vertices of tiles");
    corners_ = uploaded(bodies.device(), bytes_of(tables.corners), "corners of tiles");
}

} // namespace tandem
