// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/plan_file.h"
#include "harness/plans/shard.h"

namespace tandem {

/// A scene with a range of its frames, and the cells that are measured on them together.
struct CellGroup {
    std::string scene, frames; ///< as the user named them
    std::vector<Cell> cells;
};

/// The groups of a plan, and the numbers of cells that are left out.
struct CellGroups {
    std::vector<CellGroup> groups;
    std::map<std::string, std::size_t> impossible; ///< reason, and number of cells skipped for it
    std::size_t repeated = 0;                      ///< cells named again, and dropped
    std::size_t excluded = 0;                      ///< cells removed by exclusions
    std::size_t numbered = 0;                      ///< number of groups in all shards
};

/// Replaces fields in every product of the plan: the fields of `given` that are not empty, and settings by
/// name.
void replace(PlanFile& plan, const Product& given);

/// The devices that the products name, each once; default_device for a product that names none.
std::vector<std::string> devices_of(const PlanFile& plan);

/// Returns the devices of the names, as choose_devices().
using ChooseDevices = std::function<std::vector<DeviceGroup>(const std::vector<std::string>& names)>;

/// The cells of all products without the exclusions, grouped by scene and frames in the order of the plan. A
/// group has each cell once. The numbers of groups depend only on the scenes and frames that the plan names,
/// so that all machines number them alike. Only the groups of `shard` are returned. Throws InputError as
/// plan(), and for an exclusion that matches no cell.
CellGroups make_groups(const PlanFile& plan, const ChooseDevices& choose, Shard shard = {});

/// Removes cells whose names do not match --filter (cell_filter.h), and groups without cells. Throws
/// InputError when no cell is left, unless other shards may have some.
void keep_matching(CellGroups& all, const std::string& expression, Shard shard);

} // namespace tandem
