// SPDX-License-Identifier: MIT
#include "harness/plans/cell_session.h"

#include "harness/plans/rank_team.h"

namespace tandem {

Settings session_settings(const Cell& cell, const Scene& scene) {
    const auto settings = cell.team != nullptr ? cell.team->settings_of(cell) : cell.settings;
    return cell.algorithm->fitted(settings, cell.devices.front()->info(), &scene);
}

std::unique_ptr<Session> prepare_session(const Cell& cell, const Scene& scene) {
    return cell.team != nullptr ? cell.team->prepare(cell, scene)
                                : cell.algorithm->prepare(cell.devices, scene, cell.settings);
}

std::vector<DeviceInfo> infos_of(const Cell& cell) {
    if (cell.team != nullptr) return cell.team->devices();
    std::vector<DeviceInfo> infos;
    for (const auto* device : cell.devices) infos.push_back(device->info());
    return infos;
}

} // namespace tandem
