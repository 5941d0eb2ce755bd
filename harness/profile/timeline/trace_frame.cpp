// SPDX-License-Identifier: MIT
#include "harness/profile/timeline/trace_frame.h"

#include "harness/sampling/replays.h"

#include <nlohmann/json.hpp>

namespace tandem {

nlohmann::ordered_json trace_frame(const Cell& cell, const Task& task) {
    Replays replays(cell, task.scene, task.range);
    const auto index = task.range.size() / 2;
    auto traces = replays.traced(index);
    std::vector<DeviceTimeline> devices;
    for (std::size_t i = 0; i < cell.devices.size(); ++i)
        devices.push_back({cell.devices[i]->info(), std::move(traces[i])});
    return timeline_json(devices, describe(cell), task.range.first() + index);
}

} // namespace tandem
