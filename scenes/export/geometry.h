// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/export/geometry_cut.h"
#include "scenes/export/surfaces.h"
#include "scenes/scene.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// Additional content of the geometry.
struct GeometryParts {
    /// Returns the number of the chunk of each tetrahedron of a mesh.
    std::function<std::vector<std::uint32_t>(const Mesh&)> chunks;
    /// Returns the contacts of a frame; empty: the geometry has no contacts.
    std::function<std::vector<ContactPoint>(const Frame&)> contacts{};
    FindSurfaces surfaces{}; ///< empty: the geometry has no contact surfaces
};

/// Frames of a scene as JSON text for a page that draws them: surfaces with the chunk of each triangle,
/// poses, vertices of deformable bodies, contacts (scenes/export/README.md describes the format). Leaves out
/// content beyond the budget and adds notes about it. `frames` has at least one frame, in ascending order.
std::string geometry_json(const Scene& scene, std::span<const std::size_t> frames, const GeometryParts& parts,
                          const exporting::GeometryBudget& budget = {});

/// Writes geometry_json() to a file. Throws InputError and OutputError.
void write_geometry(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                    const GeometryParts& parts);

} // namespace tandem
