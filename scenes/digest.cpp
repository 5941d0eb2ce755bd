// SPDX-License-Identifier: MIT
#include "scenes/digest.h"

#include "base/digest.h"

namespace tandem {

namespace {

void add(Digester& digester, const Eigen::Vector3d& v) {
    for (const double x : v) digester.add(x);
}

void add(Digester& digester, const Mesh& mesh) {
    digester.add(std::uint64_t{mesh.vertices.size()});
    for (const auto& v : mesh.vertices) add(digester, v);
    for (const auto& t : mesh.tetrahedra)
        for (const auto vertex : t) digester.add(std::uint64_t{vertex});
    // Meshes without them keep the digest of the time before them.
    for (const auto* list : {&mesh.merged, &mesh.welded}) {
        if (list->empty()) continue;
        digester.add(std::uint64_t{list->size()});
        for (const auto number : *list) digester.add(std::uint64_t{number});
    }
    if (mesh.pressures.empty()) return;
    digester.add(std::uint64_t{mesh.pressures.size()});
    for (const double pressure : mesh.pressures) digester.add(pressure);
}

void add(Digester& digester, const Frame& frame) {
    for (const auto& pose : frame.poses) {
        for (const double x : pose.rotation.coeffs()) digester.add(x);
        add(digester, pose.translation);
    }
    for (const auto& vertices : frame.deformed)
        for (const auto& v : vertices) add(digester, v);
}

} // namespace

std::uint64_t digest_of(const Frame& frame) {
    Digester digester;
    add(digester, frame);
    for (const auto& list : frame.skipped) {
        digester.add(std::uint64_t{list.size()});
        for (const auto tetrahedron : list) digester.add(std::uint64_t{tetrahedron});
    }
    return digester.value();
}

std::uint64_t digest_of(const Scene& scene) {
    Digester digester;
    digester.add(scene.key);
    for (const auto& mesh : scene.meshes) add(digester, mesh);
    for (const auto& body : scene.bodies)
        digester.add(std::uint64_t{body.mesh} << 2 | (body.fixed ? 1u : 0u) | (body.deformable ? 2u : 0u));
    if (scene.world_size != 0) digester.add(std::uint64_t{scene.world_size});
    if (has_filters(scene)) {
        for (const auto& body : scene.bodies) digester.add(std::uint64_t{body.groups} << 32 | body.meets);
        for (const auto& [a, b] : scene.never_meet) digester.add(std::uint64_t{a} << 32 | b);
    }
    add(digester, scene.frame(0));
    add(digester, scene.frame(scene.frame_count - 1));
    return digester.value();
}

} // namespace tandem
