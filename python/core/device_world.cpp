// SPDX-License-Identifier: MIT
#include "python/core/device_world.h"

#include "algorithms/bodies/moved_coordinate.h"
#include "base/parallel.h"

namespace tandem::python {

namespace {

template<class Real>
using Row = std::array<Real, 4>;

template<class Real>
std::vector<Row<Real>> downloaded_rows(Device& device, const Buffer& buffer, std::size_t count) {
    const StageScope scope(device, Stage::read);
    std::vector<Row<Real>> rows(count);
    device.download(buffer, std::as_writable_bytes(std::span(rows)));
    return rows;
}

/// `pose`: the three rows of the body's pose; null: its vertices are in world coordinates.
template<class Real>
std::array<double, 3> placed(const Row<Real>* pose, const Row<Real>& point) {
    std::array<double, 3> at{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] = static_cast<double>(pose != nullptr ? moved_coordinate(pose[axis], point) : point[axis]);
    return at;
}

template<class Real>
oracle::World world_in(const Bodies& bodies) {
    const auto& scene = bodies.scene();
    const auto pose_rows = pose_reals(bodies.geometry()) / 4;
    const auto vertices = downloaded_rows<Real>(bodies.device(), bodies.vertices(), bodies.vertex_total());
    const auto poses = downloaded_rows<Real>(bodies.device(), bodies.poses(), bodies.count() * pose_rows);
    oracle::World world(scene.bodies.size());
    parallel_for(world.size(), [&](std::size_t body) {
        const auto& numbers = bodies.mesh(body).numbers;
        const auto* const pose = scene.bodies[body].deformable ? nullptr : &poses[body * pose_rows];
        for (const auto& tetrahedron : scene.meshes[scene.bodies[body].mesh].tetrahedra) {
            auto& corners = world[body].emplace_back();
            for (std::size_t i = 0; i < 4; ++i) // a tetrahedron of unused vertices is in no pair
                if (const auto number = numbers[tetrahedron[i]]; number != OrderedMesh::unused)
                    corners[i] = placed(pose, vertices[bodies.row(body).vertices + number]);
        }
    });
    return world;
}

} // namespace

oracle::World world_on_device(const Bodies& bodies) {
    return bodies.geometry().precision == Precision::fp64 ? world_in<double>(bodies)
                                                          : world_in<float>(bodies);
}

} // namespace tandem::python
