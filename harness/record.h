// SPDX-License-Identifier: MIT
#pragma once

#include "harness/sampler.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// One measured cell as the JSON object of results/record.schema.json. `failure` is the reason when the cell
/// did not finish; `measurement` is then what there is.
nlohmann::ordered_json make_record(const Cell& cell, const Scene& scene, const FrameRange& range,
                                   const Measurement& measurement, const std::string& failure);

/// The parts of a record that say of what, where and with what it was made.
nlohmann::ordered_json record_scene(const Scene& scene);
nlohmann::ordered_json record_device(const DeviceInfo& info);
nlohmann::ordered_json record_devices(const DeviceGroup& devices);
nlohmann::ordered_json record_environment();

} // namespace tandem
