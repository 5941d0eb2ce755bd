// SPDX-License-Identifier: MIT
#include "python/core/meeting.h"

#include "algorithms/bodies/origin.h"
#include "base/error.h"
#include "base/parallel.h"
#include "geometry/meet_exactly.h"
#include "harness/verify/world_vertices.h"

namespace tandem::python {

namespace {

template<class Real>
using World = std::vector<std::vector<std::array<Real, 3>>>; ///< vertices of each body

template<class Real>
auto corners(const Scene& scene, const World<Real>& world, std::uint32_t body, std::uint32_t tetrahedron) {
    std::array<std::array<double, 3>, 4> result{};
    const auto& vertices = scene.meshes[scene.bodies[body].mesh].tetrahedra[tetrahedron];
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) result[i][axis] = world[body][vertices[i]][axis];
    return result;
}

template<class Real>
std::vector<Pair> meeting_in(const Scene& scene, const Frame& frame, std::span<const Pair> pairs) {
    World<Real> world(scene.bodies.size());
    parallel_for(world.size(),
                 [&](std::size_t body) { world[body] = world_vertices<Real>(scene, frame, body); });
    const auto parts = in_parts(pairs);
    std::vector<std::vector<Pair>> found(parts.size());
    parallel_for(parts.size(), [&](std::size_t part) {
        for (const auto& pair : parts[part])
            if (meet_exactly(corners(scene, world, pair.body_a, pair.tet_a),
                             corners(scene, world, pair.body_b, pair.tet_b)))
                found[part].push_back(pair);
    });
    std::vector<Pair> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

} // namespace

std::vector<Pair> meeting_of(const Scene& scene, const Frame& frame, const Geometry& geometry,
                             const Eigen::Vector3d& origin, std::span<const Pair> pairs) {
    if (geometry.placement == Placement::exact)
        throw InputError("setting placement=exact has no rounded vertices, which meeting() decides; make the "
                         "collider without it");
    const auto moved = counted_from(origin, frame);
    return geometry.precision == Precision::fp64 ? meeting_in<double>(scene, moved, pairs)
                                                 : meeting_in<float>(scene, moved, pairs);
}

} // namespace tandem::python
