// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/device_models.h"
#include "harness/plans/frames.h"
#include "harness/plans/cells.h"

namespace tandem {

/// What a cell measures, in one line:
///   algorithm|backend:model, driver[+...]|scene with parameters@digest|first:last|settings
/// with ",degenerate=skip" behind the frames where tetrahedra were skipped. Records of equal keys are
/// comparable: they measured the same thing on the same model of device with the same driver, whichever card
/// it was and whenever.
std::string key_of(const Cell& cell, const Settings& settings, const Scene& scene, const FrameRange& range);

/// The same with other settings behind the last bar, "name=value,..." in the order of names.
std::string with_settings(const std::string& before_settings, const SettingTexts& settings);

} // namespace tandem
