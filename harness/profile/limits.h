// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem::profile {

/// What a device does at most, as the time of a kernel is held against it; 0: not known.
struct Limits {
    double bytes_per_s = 0;        ///< of device memory: read, or copied (read plus written), the better
    double cached_bytes_per_s = 0; ///< read from the cache
    double cached_bytes = 0;       ///< of the buffer that this is of: fewer bytes may all lie in the cache
    double operations_per_s = 0;   ///< comparisons of ends of slabs (algorithms/cost.h)
    double launch_s = 0;           ///< of nothing, by the clock that kernels are timed by
};

/// Those of a record of ceilings (results/ceilings.schema.json), for k-DOPs of k planes: comparisons are k a
/// test, at a rate between those of 8 and of 18 planes, linear in k, and theirs below and above. Throws
/// nlohmann::json::exception where it is no such record.
Limits limits_of(const nlohmann::ordered_json& ceilings, int k);

/// The last record of that very device in a file that 'tandem devices --measure --out' wrote: the same digest
/// of hardware, or the same name where the backend tells none. Throws InputError when there is none or the
/// file cannot be read.
nlohmann::ordered_json read_ceilings(const std::string& path, const DeviceInfo& info);

/// Throws InputError where launches of the record, which was read from `path`, were timed by another kind of
/// clock (CUPTI, events) than `device` has now: what a launch of nothing takes is mostly the clock's own.
void check_clock(const std::string& path, const nlohmann::ordered_json& ceilings, Device& device);

} // namespace tandem::profile
