// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "backends/registry.h"

#include <span>

namespace tandem {

/// The devices of one cell, which share its work: one, or several named D+E.
using DeviceGroup = std::vector<Device*>;

/// Their names, "host" or "host+opencl:0".
std::string name_of(const DeviceGroup& devices);

/// algorithm x settings x devices; the scene and frames are those of the run.
struct Cell {
    const Traversal* algorithm = nullptr;
    std::string preset;
    Settings settings; ///< resolved
    DeviceGroup devices;
};

/// What the user asked for.
struct Request {
    std::vector<std::string> algorithms; ///< empty: all
    std::vector<std::string> presets;    ///< empty: each algorithm's first; "all"
    std::vector<std::string> devices;    ///< "all": every one by itself; D+E: one cell on both
    std::vector<std::pair<std::string, std::vector<std::string>>> sets; ///< --set NAME=V1,V2
};

/// Devices of the request, in its order. Throws InputError that names the reason of absence and what there
/// is.
std::vector<DeviceGroup> choose_devices(const std::vector<BackendReport>& backends,
                                        std::span<const std::string> names);

/// What plan() does with a combination that does not fit a device or itself.
enum class Unfit { refuse, leave_out };

/// All cells: devices x algorithms x presets x every combination of values. InputErrors: a preset that none
/// of the chosen algorithms has, an algorithm chosen by name that has none of the presets, a setting that
/// none declares or that is given twice, and settings that do not fit a device or each other.
std::vector<Cell> plan(const Request& request, std::span<const DeviceGroup> devices,
                       Unfit unfit = Unfit::refuse);

/// "chunked resident on opencl:0", with the settings that differ from the preset.
std::string describe(const Cell& cell);

} // namespace tandem
