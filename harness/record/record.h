// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/rounds.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// One measured cell as the JSON object of results/record.schema.json. A failed cell has only what was
/// measured before the failure.
nlohmann::ordered_json make_record(const Cell& cell, const Scene& scene, const FrameRange& range,
                                   const Measurement& measurement, const Outcome& outcome,
                                   const Sampling& sampling);

/// The parts of a record that identify the scene, the devices and the environment.
nlohmann::ordered_json record_scene(const Scene& scene);
nlohmann::ordered_json record_device(const DeviceInfo& info);
/// As record_device(), with the clock that measures the device; reliable once the clocks have been on.
nlohmann::ordered_json record_timed_device(const Device& device);
nlohmann::ordered_json record_devices(const DeviceGroup& devices);
nlohmann::ordered_json record_environment();

} // namespace tandem
