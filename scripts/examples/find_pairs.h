// SPDX-License-Identifier: MIT
// The part of tandem that these programs use: counts the candidate pairs of two glasses.
#pragma once

#include <tandem/algorithms/traversal.h>
#include <tandem/backends/device.h>

#include <array>
#include <cstdint>

inline std::uint64_t candidate_pairs(tandem::Device& device) {
    const auto scene = tandem::make_scene("pile:bodies=2,mesh=glass,density=1,frames=1");
    const auto& chunked = tandem::algorithm("chunked");
    const auto settings =
        tandem::resolve(chunked.parameters(), {}, {{"k", "18"}, {"broad", "device"}}, chunked.name());
    const std::array<tandem::Device*, 1> devices{&device};
    const auto session = chunked.prepare(devices, scene, settings);
    return session->run(scene.frame(0)).count;
}
