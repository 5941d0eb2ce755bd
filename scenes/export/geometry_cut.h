// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tandem::exporting {

/// How much of a scene goes into one JSON document.
struct GeometryBudget {
    std::size_t bytes = 3'000'000;   ///< all meshes, poses and contacts; base64 makes four of three
    std::size_t triangles = 400'000; ///< all distinct meshes
    std::size_t drawn = 4'000'000;   ///< triangles of all bodies
    std::size_t contacts = 3000;     ///< in a frame: more hide the bodies
};

/// What a scene would take.
struct GeometrySizes {
    struct OfMesh {
        std::size_t vertices = 0, triangles = 0; ///< its surface
        std::size_t bodies = 0, deformable = 0;  ///< that have it, and those of them that are deformable
    };
    std::vector<OfMesh> meshes{};
    std::size_t bodies = 0, frames = 0;
    bool contacts = false;
};

/// Which part of it is shown.
struct GeometryCut {
    std::vector<bool> boxed; ///< meshes whose bodies are drawn as boxes
    std::size_t bodies = 0, frames = 0;
    std::size_t contacts = 0; ///< a frame at most
};

/// Bytes of a mesh: 16 bits a coordinate, and the number of a chunk's colour for each triangle.
std::size_t mesh_bytes(std::size_t vertices, std::size_t triangles);

/// Boxes instead of the largest meshes, then the first bodies only, then fewer frames, then fewer contacts.
GeometryCut cut(const GeometrySizes& sizes, const GeometryBudget& budget);

} // namespace tandem::exporting
