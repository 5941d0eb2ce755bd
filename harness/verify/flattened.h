// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <array>
#include <cstdint>
#include <span>

namespace tandem {

/// Tetrahedra of a frame that have volume, but none by the vertices as a device has them: its precision does
/// not resolve them.
struct Flattened {
    std::uint64_t tetrahedra = 0; ///< summed over bodies
    std::uint32_t body = 0;       ///< the first body with the most of them
    std::uint64_t of_body = 0;    ///< those of that body
};

/// `given`: the vertices of a mesh as they were given. `rounded`: as the device has them.
template<class Real>
std::uint64_t count_flattened(const Mesh& mesh, std::span<const Eigen::Vector3d> given,
                              std::span<const std::array<Real, 3>> rounded);

/// `frame` is relative to the session's origin. With double nothing is counted.
Flattened count_flattened(const Scene& scene, const Frame& frame, const Geometry& geometry);

} // namespace tandem
