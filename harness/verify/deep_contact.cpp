// SPDX-License-Identifier: MIT
#include "harness/verify/deep_contact.h"

#include <algorithm>

namespace tandem {

namespace {

double size_of(const std::vector<Eigen::Vector3d>& vertices) {
    Eigen::AlignedBox3d box;
    for (const auto& vertex : vertices) box.extend(vertex);
    return box.isEmpty() ? 0 : box.diagonal().norm();
}

/// By body; a pose does not change the size.
std::vector<double> sizes_of(const Scene& scene, const Frame& frame) {
    std::vector<double> of_meshes;
    for (const auto& mesh : scene.meshes) of_meshes.push_back(size_of(mesh.vertices));
    std::vector<double> sizes;
    for (std::size_t body = 0; body < scene.bodies.size(); ++body)
        sizes.push_back(scene.bodies[body].deformable ? size_of(frame.deformed[body])
                                                      : of_meshes[scene.bodies[body].mesh]);
    return sizes;
}

} // namespace

std::optional<DeepContact> deepest_beyond_body(const Scene& scene, const Frame& frame, std::size_t number,
                                               std::span<const ContactPoint> contacts) {
    std::optional<DeepContact> deepest;
    if (contacts.empty()) return deepest;
    const auto sizes = sizes_of(scene, frame);
    for (const auto& contact : contacts) {
        const auto& pair = contact.pair;
        const double depth = contact.depth;
        const double size = std::min(sizes[pair.body_a], sizes[pair.body_b]);
        if (-depth > size && (!deepest || depth < deepest->depth))
            deepest = DeepContact{number, pair.body_a, pair.tet_a, pair.body_b, pair.tet_b, depth, size};
    }
    return deepest;
}

} // namespace tandem
