// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem::profile {

/// The maximum rates of a device that the floors of kernels use; 0: unknown.
struct Limits {
    double bytes_per_s = 0;        ///< device memory: the better of read and copy (read plus written)
    double cached_bytes_per_s = 0; ///< read from the cache
    double cached_bytes = 0;       ///< buffer size of that measurement: fewer bytes may all fit the cache
    double operations_per_s = 0;   ///< comparisons of slab bounds (algorithms/bodies/cost.h)
    double launch_s = 0;           ///< an empty launch, by the clock that times kernels
};

/// The limits of a record of ceilings (results/ceilings.schema.json) for k-DOPs of k planes. A test makes k
/// comparisons; their rate is interpolated between k = 8 and k = 18, and constant outside. Throws
/// nlohmann::json::exception when the JSON is no such record.
Limits limits_of(const nlohmann::ordered_json& ceilings, int k);

/// The last record of this device in a file of 'tandem devices --measure --out'. Devices match by the digest
/// of their hardware, or by name when the backend reports no digest. Throws InputError when there is no such
/// record or the file cannot be read.
nlohmann::ordered_json read_ceilings(const std::string& path, const DeviceInfo& info);

/// Throws InputError when the launches of the record, read from `path`, were timed by another kind of clock
/// (CUPTI, events) than `device` uses. The time of an empty launch is mostly the cost of the clock itself.
void check_clock(const std::string& path, const nlohmann::ordered_json& ceilings, Device& device);

} // namespace tandem::profile
