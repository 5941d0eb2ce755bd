// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tandem::exporting {

/// Limits of one JSON document.
struct GeometryBudget {
    std::size_t bytes =
        3'000'000; ///< meshes, poses, contacts and surfaces, before base64, which adds a third
    std::size_t triangles = 400'000; ///< triangles of all distinct meshes
    std::size_t drawn = 4'000'000;   ///< triangles of all bodies
    std::size_t contacts = 3000;     ///< contacts in a frame; more would hide the bodies
};

/// Sizes of a complete scene.
struct GeometrySizes {
    struct MeshSizes {
        std::size_t vertices = 0, triangles = 0; ///< counts of the surface
        std::size_t bodies = 0, deformable = 0; ///< bodies with this mesh, and the deformable ones among them
    };
    std::vector<MeshSizes> meshes{};
    std::size_t bodies = 0, frames = 0;
    std::size_t surface_bytes = 0; ///< of the contact surfaces of a frame
    bool contacts = false;
};

/// The part of a scene that fits the budget.
struct GeometryCut {
    std::vector<bool> boxed; ///< one a mesh: true when its bodies are drawn as boxes
    std::size_t bodies = 0, frames = 0;
    std::size_t contacts = 0;      ///< maximum in a frame
    std::size_t surface_bytes = 0; ///< maximum in a frame
};

/// Bytes of a mesh: 16 bits a coordinate, vertex indices, and one byte for the chunk of each triangle.
std::size_t mesh_bytes(std::size_t vertices, std::size_t triangles);

/// Reduces a scene to the budget: boxes replace the largest meshes, then bodies, frames and contacts are
/// limited, in this order. Contact surfaces are whole if fewer frames make them so.
GeometryCut cut(const GeometrySizes& sizes, const GeometryBudget& budget);

} // namespace tandem::exporting
