// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/plans/device_groups.h"
#include "base/error.h"

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>

namespace tandem {

class RankTeam; // ranks/rank_team.h

/// A cell: algorithm x settings x devices. The run adds the scene and frames.
struct Cell {
    const Traversal* algorithm = nullptr;
    std::string preset;
    Settings settings; ///< resolved: every setting has a value
    DeviceGroup devices;
    RankTeam* team = nullptr; ///< the ranks of a job that measure it together; null: this process alone
    /// Only for `auto`: the cells to choose from, which give the same answer. Until the choice, this cell
    /// equals the first of them.
    std::vector<Cell> candidates{};
    /// How auto chose it, as in its record (choosing/choice.h); null when the user named it.
    std::shared_ptr<const nlohmann::ordered_json> chosen{};
};

/// The algorithm name that stands for the fastest of all algorithms.
inline constexpr std::string_view automatic = "auto";

/// The cells that the user asked for.
struct Request {
    std::vector<std::string> algorithms; ///< empty or "all": all, without auto
    std::vector<std::string> presets;    ///< empty: the first of each algorithm; "all": all
    std::vector<std::string> devices;    ///< "all": one cell on each device; D+E: one cell on both
    std::vector<std::pair<std::string, std::vector<std::string>>> sets; ///< --set NAME=V1,V2
    bool may_choose = false;                                            ///< whether `auto` is allowed
};

/// Called with the error of a combination that does not fit its device, its scene or itself: refuse() throws
/// the error again, leave_out() does nothing.
using Unfit = std::function<void(const InputError&)>;
[[noreturn]] void refuse(const InputError& error);
inline void leave_out(const InputError&) {}

/// All cells: devices x algorithms x presets x every combination of values; for auto, devices x every
/// combination. Throws InputError for a preset that no chosen algorithm has, an algorithm chosen by name that
/// has none of the presets, an unknown or repeated setting, and auto where it is not allowed. Settings that
/// do not fit a device or each other go to `unfit`.
std::vector<Cell> plan(const Request& request, std::span<const DeviceGroup> devices,
                       const Unfit& unfit = refuse);

/// Removes repeated cells and returns their number. Cells of auto are kept.
std::size_t drop_repeated(std::vector<Cell>& cells);

/// The presets of `traversal` that the request names; the first preset when the request names none. Throws
/// InputError when the request names this algorithm but none of its presets.
std::vector<const Preset*> choose_presets(const Request& request, const Traversal& traversal);

/// Makes one cell. Throws InputError when the settings do not fit the devices.
Cell make_cell(const Traversal& traversal, const Preset& preset, const SettingTexts& given,
               const DeviceGroup& devices);

/// The settings that differ from the preset. Equal cells have equal changes, however the user named them.
SettingTexts changes(const Cell& cell);

/// The part of a cell's name that tables of one device need: "grouped schedule" (title_of), with the settings
/// that differ from the preset after it, except those of `left_out`; "auto" before auto has chosen.
std::string method_of(const Cell& cell, const SettingTexts& left_out = {});

/// The name of a cell in tables, messages and --filter: "grouped schedule on opencl:0", with the settings
/// that differ from the preset before "on"; "auto on opencl:0" before auto has chosen.
std::string describe(const Cell& cell);

} // namespace tandem
