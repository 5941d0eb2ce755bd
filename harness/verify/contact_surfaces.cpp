// SPDX-License-Identifier: MIT
#include "harness/verify/contact_surfaces.h"

#include "algorithms/bodies/origin.h"
#include "algorithms/narrow_phase/reference.h"
#include "base/parallel.h"

namespace tandem {

namespace {

template<class Real>
GivenTetrahedron<Real> given(const Scene& scene, const oracle::World& world, std::uint32_t body,
                             std::uint32_t tetrahedron) {
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    const auto& corners = world[body][tetrahedron];
    GivenTetrahedron<Real> result{};
    for (unsigned i = 0; i < 4; ++i) {
        for (unsigned k = 0; k < 3; ++k) result.corners[i][k] = static_cast<Real>(corners[i][k]);
        if (!mesh.pressures.empty())
            result.pressures[i] = static_cast<Real>(mesh.pressures[mesh.tetrahedra[tetrahedron][i]]);
    }
    return result;
}

template<class Real>
ContactSurfaces surfaces_in(const Scene& scene, const oracle::World& world,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows) {
    std::vector<PolygonCorners<Real>> polygons(rows.size());
    parallel_for(rows.size(), [&](std::size_t i) {
        const auto& pair = rows[i].pair;
        polygons[i] = polygon_of_equal_pressure(given<Real>(scene, world, pair.body_a, pair.tet_a),
                                                given<Real>(scene, world, pair.body_b, pair.tet_b));
    });
    ContactSurfaces surfaces;
    for (const auto& polygon : polygons) {
        for (const auto& point : polygon.points) {
            auto& corner = surfaces.corners.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) corner[k] = static_cast<double>(point[k]) + origin[k];
        }
        for (const Real pressure : polygon.pressures)
            surfaces.pressures.push_back(static_cast<double>(pressure));
        surfaces.ends.push_back(surfaces.corners.size());
    }
    return surfaces;
}

} // namespace

ContactSurfaces surfaces_of(const Scene& scene, const oracle::World& world, Precision precision,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows) {
    return precision == Precision::fp64 ? surfaces_in<double>(scene, world, origin, rows)
                                        : surfaces_in<float>(scene, world, origin, rows);
}

ContactSurfaces surfaces_of(const Scene& scene, const Frame& frame, const Geometry& geometry,
                            const std::array<double, 3>& origin, std::span<const ContactPoint> rows) {
    const auto counted = counted_from({origin[0], origin[1], origin[2]}, frame);
    const auto world = oracle::world_of(scene, counted, geometry.precision, geometry.origin);
    return surfaces_of(scene, world, geometry.precision, origin, rows);
}

} // namespace tandem
