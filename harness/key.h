// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames.h"
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

/// What stands for a device in a key: "cuda:NVIDIA H200, CUDA 13.0, 580.159.04"; a processor with the number
/// of its cores, "host:AMD EPYC x2, g++ 12.2.0, lanes for x86-64-v3".
std::string model_of(const DeviceInfo& info);

} // namespace tandem
