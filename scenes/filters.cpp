// SPDX-License-Identifier: MIT
#include "scenes/scene.h"

#include <algorithm>
#include <iterator>

namespace tandem {

bool may_meet(const Scene& scene, std::uint32_t a, std::uint32_t b) {
    const auto& one = scene.bodies[a];
    const auto& other = scene.bodies[b];
    if (one.fixed && other.fixed) return false;
    if (world_of(scene, a) != world_of(scene, b)) return false;
    if (a != b && ((one.groups & other.meets) == 0 || (other.groups & one.meets) == 0)) return false;
    return !std::ranges::binary_search(scene.never_meet, std::array{std::min(a, b), std::max(a, b)});
}

std::vector<std::uint32_t> deformable_bodies(const Scene& scene) {
    std::vector<std::uint32_t> bodies;
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (scene.bodies[body].deformable) bodies.push_back(body);
    return bodies;
}

std::vector<std::uint32_t> skipped_in(const Scene& scene, const Frame& frame, std::size_t body) {
    const auto& merged = scene.meshes[scene.bodies[body].mesh].merged;
    if (frame.skipped.empty()) return merged;
    std::vector<std::uint32_t> both;
    std::ranges::set_union(merged, frame.skipped[body], std::back_inserter(both));
    return both;
}

bool has_filters(const Scene& scene) {
    const Body usual;
    return scene.world_size != 0 || !scene.never_meet.empty()
           || std::ranges::any_of(scene.bodies, [&](const Body& body) {
                  return body.groups != usual.groups || body.meets != usual.meets;
              });
}

} // namespace tandem
