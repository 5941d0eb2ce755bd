// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "backends/registry.h"

#include <map>

namespace tandem {

/// algorithm x settings x device; the scene and frames are those of the run.
struct Cell {
    const Traversal* algorithm = nullptr;
    std::string preset;
    Settings settings; ///< resolved
    Device* device = nullptr;
};

/// What the user asked for.
struct Request {
    std::vector<std::string> algorithms; ///< empty: all
    std::vector<std::string> presets;    ///< empty: each algorithm's first; "all"
    std::vector<std::string> devices;    ///< "all": every one
    std::vector<std::pair<std::string, std::vector<std::string>>> sets; ///< --set NAME=V1,V2
};

/// Devices of the request, in its order. Throws InputError that names the reason of absence and what there
/// is.
std::vector<Device*> choose_devices(const std::vector<BackendReport>& backends,
                                    std::span<const std::string> names);

/// What plan() does with a combination that does not fit a device or itself.
enum class Unfit { refuse, leave_out };

/// All cells: devices x algorithms x presets x every combination of values. InputErrors: a preset that none
/// of the chosen algorithms has, an algorithm chosen by name that has none of the presets, a setting that
/// none declares or that is given twice, and settings that do not fit a device or each other.
std::vector<Cell> plan(const Request& request, std::span<Device* const> devices, Unfit unfit = Unfit::refuse);

/// "chunked resident on opencl:0", with the settings that differ from the preset.
std::string describe(const Cell& cell);

} // namespace tandem
