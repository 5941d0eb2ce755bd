// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/device_models.h"
#include "harness/frames/frames.h"
#include "harness/plans/cells.h"

namespace tandem {

/// The key of a cell, in one line:
///   algorithm|backend:model, driver[+...]|scene with parameters@digest|first:last|settings
/// ",degenerate=skip" follows the frames when tetrahedra were skipped. Records with equal keys are
/// comparable: they measured the same work on the same model of device with the same driver.
std::string key_of(const Cell& cell, const Settings& settings, const Scene& scene, const FrameRange& range);

/// A key from the part before the settings. Settings are added as "name=value,..." in the order of names.
std::string with_settings(const std::string& before_settings, const SettingTexts& settings);

} // namespace tandem
