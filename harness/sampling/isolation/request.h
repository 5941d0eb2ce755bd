// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/isolation/isolated_sampler.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// A request to a child process to do one step of measuring a cell.
struct IsolatedWork {
    std::string work;        ///< "check", "round" or "count"
    std::size_t samples = 0; ///< of a round
    CheckOptions check;      ///< without truths and progress, which are not sent
};

/// `options` select the scene, its frames and the check.
nlohmann::json request_json(const RunOptions& options, const CellSampler& sampler, const IsolatedWork& work);

/// A request as the child receives it, before it opens the scene.
struct IsolatedRequest {
    RunOptions options;
    IsolatedWork work;
    std::string algorithm, preset, devices;
    SettingTexts settings;
};
IsolatedRequest request_of(const nlohmann::json& json);

} // namespace tandem
