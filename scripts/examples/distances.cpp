// SPDX-License-Identifier: MIT
// distances: the clearance of two bodies that approach: for every step the least distance within a margin,
// with the closest points. Errors are one line and exit code 1.
#include <tandem/tandem.h>

#include <array>
#include <cstdio>

namespace {

tandem::Mesh tetrahedron() {
    tandem::Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    tandem::complete_mesh(mesh, "tetrahedron"); // throws InputError for a flaw, and finds the boundary
    return mesh;
}

/// The second body approaches along x.
tandem::Frame poses(std::size_t step) {
    tandem::Frame frame{.poses = std::vector<tandem::Pose>(2), .deformed = {{}, {}}};
    frame.poses[1].translation = {1.5 - 0.25 * static_cast<double>(step), 0.0625, 0.0625};
    return frame;
}

void run(tandem::Device& device) {
    tandem::Scene scene;
    scene.name = scene.key = "two tetrahedra";
    scene.meshes = {tetrahedron()};
    scene.bodies.resize(2); // both have mesh 0
    const auto& tiled = tandem::algorithm("tiled");
    const std::array devices{&device};
    const auto session =
        tiled.prepare(devices, scene, tiled.settings({{"margin", "0.3"}, {"output", "distances"}}));
    for (std::size_t step = 0; step < 4; ++step) {
        const auto closest = session->run(poses(step)).download_contacts(); // one of each pair of bodies
        if (closest.empty()) std::printf("step %zu: farther than 0.3\n", step);
        for (const auto& pair : closest) {
            const auto &a = pair.point, b = other_point(pair);
            std::printf("step %zu: %.3f from %.3f %.3f %.3f to %.3f %.3f %.3f\n", step, pair.depth, a[0],
                        a[1], a[2], b[0], b[1], b[2]);
        }
    }
}

} // namespace

int main() {
    try {
        const auto device = tandem::host::make_device(); // or one of tandem::discover()
        run(*device);
    } catch (const std::exception& error) { // tandem::InputError, tandem::DeviceError
        std::fprintf(stderr, "distances: %s\n", error.what());
        return 1;
    }
}
