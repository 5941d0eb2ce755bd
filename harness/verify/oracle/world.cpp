// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/world.h"

#include "harness/verify/world_vertices.h"
#include "base/parallel.h"

namespace tandem::oracle {

namespace {

template<class Real>
World world_in(const Scene& scene, const Frame& frame, Origin origin) {
    World world(scene.bodies.size());
    parallel_for(world.size(), [&](std::size_t body) {
        const auto vertices = world_vertices<Real>(scene, frame, body, origin);
        for (const auto& tetrahedron : scene.meshes[scene.bodies[body].mesh].tetrahedra) {
            auto& corners = world[body].emplace_back();
            for (unsigned i = 0; i < 4; ++i)
                for (unsigned axis = 0; axis < 3; ++axis)
                    corners[i][axis] = static_cast<double>(vertices[tetrahedron[i]][axis]);
        }
    });
    return world;
}

} // namespace

World world_of(const Scene& scene, const Frame& frame, Precision precision, Origin origin) {
    return precision == Precision::fp64 ? world_in<double>(scene, frame, origin)
                                        : world_in<float>(scene, frame, origin);
}

} // namespace tandem::oracle
