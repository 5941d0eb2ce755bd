// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/cubes.h"
#include "scenes/scene.h"

namespace tandem {

/// Edge of the cubes of a bar in m: a power of two, so that vertices and numbers of sections are exact.
constexpr double bar_edge = 0.25;

/// Mesh of cubes with edges of bar_edge, six tetrahedra each. A bar begins at x = 0 and is centred in y and
/// z. No tetrahedron is inverted. Throws InputError when it exceeds memory.
Mesh bar(const std::string& name, const CubeCounts& counts);

/// Where a bar's cross-section is: world coordinates of its centre, and the directions of its y and z.
struct Section {
    Eigen::Vector3d centre, along_y, along_z;
};

/// Drift of a line towards z, per length. Without it, the cubes of layers that fold onto each other would
/// have sides in common planes, so that thousands of pairs only touched.
constexpr double bar_drift = 0x1p-6;

/// `count` sections along a line in the xy-plane with this drift. They are `spacing` apart along the line,
/// and the first is at the origin. `slope(s)` is the line's angle against x in radians after the length s.
/// along_z is the z-axis.
std::vector<Section> plane_line(std::size_t count, double spacing, double drift,
                                const std::function<double(double)>& slope);

/// Number and motion of bodies. `amount` is how far the motion has come: from 0 to 1 in 100 steps, the
/// tightest frame, and back in the next 100, with speed 0 at both ends.
struct Bars {
    std::uint64_t count; ///< bodies
    /// Sections of a body, `spacing` apart along it.
    std::function<std::vector<Section>(std::size_t sections, double spacing, double amount, std::size_t body)>
        line;
    std::function<Eigen::Vector3d(std::size_t body)> offset; ///< is added to the world vertices of a body
};

/// Deformable bodies of one bar. The parameter `frames` is their number of frames, and `refine` refines them.
/// Throws InputError when they exceed memory.
Scene scene_of(const Bars& bars, const Mesh& bar, std::span<const SceneParameter> parameters);

} // namespace tandem
