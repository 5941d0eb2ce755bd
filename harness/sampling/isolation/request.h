// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/isolation/isolated_sampler.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// What a process of its own is to do with a cell.
struct IsolatedWork {
    std::string work;        ///< "check", "round" or "count"
    std::size_t samples = 0; ///< of a round
    CheckOptions check;      ///< its truths and progress are not sent
};

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
