// SPDX-License-Identifier: MIT
// surfaces: a compliant pyramid is pressed into another: for every step area and force of the contact
// surface, summed up on the device. Errors are one line and exit code 1.
#include <tandem/tandem.h>

#include <array>
#include <cstdio>

namespace {

/// Four tetrahedra over the base, which is at z = 0; the pressure rises from the surface to the inner vertex.
tandem::Mesh pyramid() {
    tandem::Mesh mesh;
    mesh.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 1}, {0, 0, 0.25}};
    mesh.tetrahedra = {{0, 1, 4, 5}, {1, 2, 4, 5}, {2, 3, 4, 5}, {3, 0, 4, 5}, {0, 2, 1, 5}, {0, 3, 2, 5}};
    mesh.pressures = {0, 0, 0, 0, 0, 1e6};
    tandem::complete_mesh(mesh, "pyramid"); // throws InputError for a flaw, and finds the boundary
    return mesh;
}

/// The second one comes from above, upside down.
tandem::Frame poses(std::size_t step) {
    tandem::Frame frame{.poses = std::vector<tandem::Pose>(2), .deformed = {{}, {}}};
    frame.poses[1].rotation = {0, 1, 0, 0};
    frame.poses[1].translation = {0.125, 0.0625, 2.25 - 0.5 * static_cast<double>(step)};
    return frame;
}

void run(tandem::Device& device) {
    tandem::Scene scene;
    scene.name = scene.key = "two pyramids";
    scene.meshes = {pyramid()};
    scene.bodies.resize(2); // both have mesh 0
    const auto& tiled = tandem::algorithm("tiled");
    const std::array devices{&device};
    const auto session = tiled.prepare(devices, scene, tiled.settings({{"output", "wrenches"}}));
    for (std::size_t step = 0; step < 4; ++step) {
        const auto sums = session->run(poses(step)).download_contacts(); // one row for each pair of bodies
        if (sums.empty()) std::printf("step %zu: no contact\n", step);
        for (const auto& row : sums)
            std::printf("step %zu: %u polygons, area %.4f, force on the lower one %.0f %.0f %.0f\n", step,
                        row.feature, row.depth, row.point[0], row.point[1], row.point[2]);
    }
}

} // namespace

int main() {
    try {
        const auto device = tandem::host::make_device(); // or one of tandem::discover()
        run(*device);
    } catch (const std::exception& error) { // tandem::InputError, tandem::DeviceError
        std::fprintf(stderr, "surfaces: %s\n", error.what());
        return 1;
    }
}
