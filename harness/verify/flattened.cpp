// SPDX-License-Identifier: MIT
#include "harness/verify/flattened.h"

#include "base/parallel.h"
#include "geometry/volume.h"
#include "harness/verify/world_vertices.h"

namespace tandem {

namespace {

template<class Points>
TetraCorners corners_of(const Points& points, const Tetrahedron& tetrahedron) {
    TetraCorners corners;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis)
            corners[i][axis] = static_cast<double>(points[tetrahedron[i]][axis]);
    return corners;
}

} // namespace

template<class Real>
std::uint64_t count_flattened(const Mesh& mesh, std::span<const Eigen::Vector3d> given,
                              std::span<const std::array<Real, 3>> rounded) {
    std::uint64_t count = 0;
    for (const auto& tetrahedron : mesh.tetrahedra)
        if (!has_volume(corners_of(rounded, tetrahedron)) && has_volume(corners_of(given, tetrahedron)))
            ++count;
    return count;
}

Flattened count_flattened(const Scene& scene, const Frame& frame, const Geometry& geometry) {
    Flattened result;
    if (geometry.precision == Precision::fp64) return result;
    std::vector<std::uint64_t> counts(scene.bodies.size());
    parallel_for(counts.size(), [&](std::size_t body) {
        const auto& mesh = scene.meshes[scene.bodies[body].mesh];
        const auto& given = scene.bodies[body].deformable ? frame.deformed[body] : mesh.vertices;
        const auto rounded = world_vertices<float>(scene, frame, body, geometry.origin);
        counts[body] = count_flattened<float>(mesh, given, rounded);
    });
    for (std::uint32_t body = 0; body < counts.size(); ++body) {
        result.tetrahedra += counts[body];
        if (counts[body] <= result.of_body) continue;
        result.body = body;
        result.of_body = counts[body];
    }
    return result;
}

} // namespace tandem
