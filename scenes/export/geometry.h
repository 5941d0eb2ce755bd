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

/// Frames of a scene as JSON text for a page that draws them, of about 4 MB at most. Leaves out content
/// beyond the budget and adds notes about it. `frames` has at least one frame, in ascending order.
///
/// Format: one object. Every array of numbers is a text: little-endian bytes in base64. Points have 16 bits
/// per coordinate, as fractions of a box: coordinate = `lower` + `size` * number / 65535.
/// - `name`, `key`, `units`: the scene's own. `frames`: numbers of the frames shown, of `of_frames`
///   requested. `bodies` of `of_bodies`, `tetrahedra`. `times` of the frames, where the scene has times.
/// - `meshes`: `name`; `lower`, `size`, `points` of the surface's vertices; `triangles`, three vertices each
///   in 16 bits, or in 32 where `wide`; `chunks`, a byte per triangle, the number of its chunk modulo 256.
/// - `body_meshes`, `body_kinds`: each body's mesh (32 bits), and a byte: 1 fixed, 2 deformable.
/// - `lower`, `size`, `poses`: for each frame seven numbers per body: translation in this box, then the
///   quaternion x, y, z, w as (number - 32768) / 32767.
/// - `deformed`: for each frame `lower`, `size`, `points` of each deformable body's surface.
/// - `contacts`, for each frame: how many were `found`; `lower`, `size`, `points` of those shown; `normals`
///   out of body a, three signed bytes each, as number / 127; `depths`, 16 bits each: penetration = `deepest`
///   * number / 65534, and 65535 where a contact has no depth.
/// - `surfaces`, for each frame: how many polygons were `found`; of those shown, the largest, the number of
///   `corners`, a byte each; `lower`, `size`, `points` of all corners; `pressures` there, 16 bits each:
///   `most_pressure` * number / 65535.
/// - `deepest`, `most_pressure`: the largest value shown in all frames. `colours`: from 0 to that, 0xRRGGBB,
///   at equal distances.
/// - `notes`: sentences about what is left out.
std::string geometry_json(const Scene& scene, std::span<const std::size_t> frames, const GeometryParts& parts,
                          const exporting::GeometryBudget& budget = {});

/// Writes geometry_json() to a file. Throws InputError and OutputError.
void write_geometry(const std::string& path, const Scene& scene, std::span<const std::size_t> frames,
                    const GeometryParts& parts);

} // namespace tandem
