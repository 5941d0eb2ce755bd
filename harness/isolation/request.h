// SPDX-License-Identifier: MIT
#pragma once

#include "harness/isolation/isolated_sampler.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// What a process of its own is to do with a cell.
struct IsolatedWork {
    std::string work;        ///< "check", "round" or "count"
    std::size_t samples = 0; ///< of a round
    CheckOptions check;      ///< its truths and progress are not sent
};

/// Those of the options that say of what scene, which frames and how they are checked.
nlohmann::json options_json(const RunOptions& options);
void take_options(RunOptions& options, const nlohmann::json& json);

/// A cell but for its devices, with how it was chosen or what it is to be chosen from.
nlohmann::json cell_json(const Cell& cell);
/// The same back, on these devices. Throws InputError where it does not fit them.
Cell cell_of(const nlohmann::json& json, const DeviceGroup& devices);

/// Asks for a cell of auto to be decided: answered with "cell". `options` are those of the scene, its frames
/// and of choosing.
nlohmann::json choosing_json(const RunOptions& options, const Cell& cell);

/// `options` are those of the scene, its frames and the check.
nlohmann::json request_json(const RunOptions& options, const CellSampler& sampler, const IsolatedWork& work);

/// The same on the other side; the scene is yet to be opened.
struct IsolatedRequest {
    RunOptions options;
    IsolatedWork work;
    std::string algorithm, preset, devices;
    SettingTexts settings;
};
IsolatedRequest request_of(const nlohmann::json& json);

} // namespace tandem
