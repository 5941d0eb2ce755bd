// SPDX-License-Identifier: MIT
// Finds the candidate pairs of two glasses with the installed library and prints how many there are.
#include "algorithms/broad/broad.h"
#include "algorithms/traversal.h"
#include "backends/host/host_device.h"

#include <array>
#include <cstdio>

int main() {
    const auto device = tandem::host::make_device();
    const auto scene = tandem::make_scene("pile:bodies=2,mesh=glass,density=1,frames=1");
    const auto& chunked = tandem::algorithm("chunked");
    const auto settings = tandem::resolve(chunked.parameters(), {}, {{"k", "18"}}, chunked.name());
    const std::array<tandem::Device*, 1> devices{device.get()};
    const auto session = chunked.prepare(devices, scene, settings);
    const tandem::Broad broad(scene, tandem::geometry_of(settings), tandem::broad_bound(settings));
    const auto frame = scene.frame(0);
    const auto result = session->run(frame, broad.pairs(frame));
    std::printf("%llu candidate pairs\n", static_cast<unsigned long long>(result.count));
    return result.count > 0 ? 0 : 1;
}
