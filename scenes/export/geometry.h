// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/export/geometry_cut.h"
#include "scenes/scene.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// What geometry has besides the scene.
struct GeometryParts {
    /// The number of the chunk over each tetrahedron of a mesh.
    std::function<std::vector<std::uint32_t>(const Mesh&)> chunks;
    /// The contacts of a frame; empty: the geometry has none.
    std::function<std::vector<ContactPoint>(const Frame&)> contacts{};
};

/// Frames of a scene as JSON text for a page to draw: surfaces with the chunk of each triangle, poses,
/// vertices of deformable bodies, contacts (scenes/export/README.md describes the format). What does not fit
/// the budget is left out, and its notes say so. `frames` ascend, one at least.
std::string geometry_json(const Scene& scene, std::span<const std::size_t> frames, const GeometryParts& parts,
                          const exporting::GeometryBudget& budget = {});

/// Writes that text into a file. Throws InputError and OutputError.
void write_geometry(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                    const GeometryParts& parts);

} // namespace tandem
