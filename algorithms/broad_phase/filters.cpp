// SPDX-License-Identifier: MIT
#include "algorithms/broad_phase/filters.h"

#include "backends/upload.h"

namespace tandem {

namespace {

/// The table `filters` of filters.clh.
std::vector<std::uint32_t> filter_table(const Scene& scene) {
    const auto count = static_cast<std::uint32_t>(scene.bodies.size());
    std::vector<std::uint32_t> table{count};
    for (const auto& body : scene.bodies) table.insert(table.end(), {body.groups, body.meets});
    for (std::uint32_t body = 0; body < count; ++body) table.push_back(world_of(scene, body));
    auto next = scene.never_meet.begin();
    for (std::uint32_t body = 0; body <= count; ++body) {
        while (next != scene.never_meet.end() && (*next)[0] < body) ++next;
        table.push_back(static_cast<std::uint32_t>(next - scene.never_meet.begin()));
    }
    for (const auto& pair : scene.never_meet) table.push_back(pair[1]);
    return table;
}

} // namespace

Buffer uploaded_filters(Device& device, const Scene& scene) {
    const auto filters = has_filters(scene) ? filter_table(scene) : std::vector<std::uint32_t>(1);
    return uploaded(device, bytes_of(filters), "filters of bodies");
}

} // namespace tandem
