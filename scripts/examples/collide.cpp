// SPDX-License-Identifier: MIT
// collide: a mesh and poses of one's own. Prints for every step the pairs of tetrahedra whose bounds overlap,
// and the deepest contact of those that meet. Errors are one line and exit code 1.
#include <tandem/tandem.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace {

/// A cube of edge 1, of five tetrahedra.
tandem::Mesh cube() {
    tandem::Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    mesh.tetrahedra = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
    tandem::complete_mesh(mesh, "cube"); // throws InputError for a flaw, and finds the boundary
    return mesh;
}

/// Two cubes; the second one approaches along x.
tandem::Frame poses(std::size_t step) {
    tandem::Frame frame{.poses = std::vector<tandem::Pose>(2), .deformed = {{}, {}}};
    frame.poses[1].translation = {1.05 - 0.1 * static_cast<double>(step), 0.2, 0.1};
    return frame;
}

void run(tandem::Device& device) {
    tandem::Scene scene;
    scene.name = scene.key = "two cubes";
    scene.meshes = {cube()};
    scene.bodies.resize(2); // both have mesh 0
    const auto& tiled = tandem::algorithm("tiled");
    const std::array devices{&device};
    const auto session = tiled.prepare(devices, scene, tiled.settings({{"k", "18"}}));
    for (std::size_t step = 0; step < 3; ++step) {
        const auto result = session->run(poses(step)); // in an application, from its simulation
        std::printf("step %zu: %zu candidate pairs, %zu contacts", step, result.download().size(),
                    static_cast<std::size_t>(result.contacts));
        const auto contacts = result.download_contacts();
        const auto deepest = std::ranges::min_element(contacts, {}, &tandem::ContactPoint::depth);
        if (deepest != contacts.end())
            std::printf("; the deepest is %.3f, of tetrahedra %u and %u", -deepest->depth,
                        deepest->pair.tet_a, deepest->pair.tet_b);
        std::puts("");
    }
}

} // namespace

int main() {
    try {
        const auto device = tandem::host::make_device(); // or one of tandem::discover()
        run(*device);
    } catch (const std::exception& error) { // tandem::InputError, tandem::DeviceError
        std::fprintf(stderr, "collide: %s\n", error.what());
        return 1;
    }
}
