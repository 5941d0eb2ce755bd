// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampling/rounds.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// The version of results/record.schema.json.
inline constexpr int record_schema = 4;

/// One measured cell as the JSON object of results/record.schema.json. Of a cell that failed it has what was
/// measured before.
nlohmann::ordered_json make_record(const Cell& cell, const Scene& scene, const FrameRange& range,
                                   const Measurement& measurement, const Outcome& outcome,
                                   const Sampling& sampling);

/// The parts of a record that say of what, where and with what it was made.
nlohmann::ordered_json record_scene(const Scene& scene);
nlohmann::ordered_json record_device(const DeviceInfo& info);
/// With what takes its times, certain once clocks have been on.
nlohmann::ordered_json record_timed_device(const Device& device);
nlohmann::ordered_json record_devices(const DeviceGroup& devices);
nlohmann::ordered_json record_environment();

} // namespace tandem
