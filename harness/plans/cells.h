// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"
#include "harness/plans/device_groups.h"
#include "base/error.h"

#include <functional>
#include <memory>
#include <span>

namespace tandem {

struct Choice;  // choosing/choice.h
class RankTeam; // ranks/rank_team.h

/// algorithm x settings x devices; the scene and frames are those of the run.
struct Cell {
    const Traversal* algorithm = nullptr;
    std::string preset;
    Settings settings; ///< resolved
    DeviceGroup devices;
    RankTeam* team = nullptr; ///< the ranks of a job that measure it together; null: this process alone
    /// Of `auto`: the cells it may become, which give the same answer; until one is chosen it is the first.
    std::vector<Cell> candidates{};
    std::shared_ptr<const Choice> chosen{}; ///< how it was chosen; null where the user did
};

/// What stands for the fastest of all algorithms where one may be named.
inline constexpr std::string_view automatic = "auto";

/// What the user asked for.
struct Request {
    std::vector<std::string> algorithms; ///< empty or "all": all, without auto
    std::vector<std::string> presets;    ///< empty: each algorithm's first; "all"
    std::vector<std::string> devices;    ///< "all": every one by itself; D+E: one cell on both
    std::vector<std::pair<std::string, std::vector<std::string>>> sets; ///< --set NAME=V1,V2
    bool may_choose = false;                                            ///< whether `auto` may be named
};

/// What becomes of a combination that fits no device, no scene or not itself: refused by throwing the error
/// again; left out by doing nothing.
using Unfit = std::function<void(const InputError&)>;
[[noreturn]] void refuse(const InputError& error);
inline void leave_out(const InputError&) {}

/// All cells: devices x algorithms x presets x every combination of values; of auto, devices x every
/// combination. InputErrors: a preset that none of the chosen algorithms has, an algorithm chosen by name
/// that has none of the presets, a setting that none declares or that is given twice, settings that do not
/// fit a device or each other, and auto where nothing is chosen.
std::vector<Cell> plan(const Request& request, std::span<const DeviceGroup> devices,
                       const Unfit& unfit = refuse);

/// Leaves out cells that stand there already; returns how many. Cells of auto stay.
std::size_t drop_repeated(std::vector<Cell>& cells);

/// The presets of `traversal` that the request names; its first when it names none at all. Throws InputError
/// when it has none of them and was itself named.
std::vector<const Preset*> choose_presets(const Request& request, const Traversal& traversal);

/// One cell. Throws InputError when the settings do not fit its devices.
Cell make_cell(const Traversal& traversal, const Preset& preset, const SettingTexts& given,
               const DeviceGroup& devices);

/// The settings that are not as the preset has them: equal cells have the same however they were asked for.
SettingTexts changes(const Cell& cell);

/// "chunked resident on opencl:0", with the settings that differ from the preset.
std::string describe(const Cell& cell);

} // namespace tandem
