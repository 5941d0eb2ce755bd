// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/plan_file.h"
#include "harness/plans/shard.h"

namespace tandem {

/// Frames of a scene, and the cells that are measured on them together.
struct CellGroup {
    std::string scene, frames; ///< as named
    std::vector<Cell> cells;
};

/// The groups of a plan, and what became of the rest of its cells.
struct CellGroups {
    std::vector<CellGroup> groups;
    std::map<std::string, std::size_t> impossible; ///< why, and how many are skipped for it
    std::size_t repeated = 0;                      ///< named again, and dropped
    std::size_t excluded = 0;
    std::size_t numbered = 0; ///< groups of all shards
};

/// What stands instead of the plan's own in every product: the fields that are not empty, and settings by
/// name.
void replace(PlanFile& plan, const Product& given);

/// Devices that products name, each once; opencl:0 where one names none.
std::vector<std::string> devices_of(const PlanFile& plan);

/// The devices that names ask for, as choose_devices().
using ChooseDevices = std::function<std::vector<DeviceGroup>(const std::vector<std::string>& names)>;

/// The cells of all products less the exclusions, by scene and frames in the order in which these come. Each
/// group has a cell once. Groups are numbered as the plan names scenes and frames, whatever devices and cells
/// there are, so that all machines number them alike; only those of `shard` are returned. Throws InputError
/// as plan(), and for an exclusion that matches no cell.
CellGroups make_groups(const PlanFile& plan, const ChooseDevices& choose, Shard shard = {});

} // namespace tandem
