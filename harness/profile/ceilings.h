// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// What a device can do at most. Samples are kept; empty where the device has no such thing.
struct Ceilings {
    std::vector<double> copy;          ///< device-memory copy, bytes read plus written a second
    std::vector<double> read;          ///< device-memory read, bytes a second
    std::vector<double> cache_read;    ///< read of a buffer that fits the cache, bytes a second
    std::vector<double> upload_pinned; ///< device's time of an upload from page-locked memory, bytes a second
    std::vector<double>
        upload_pageable;          ///< host's time of a blocking upload from ordinary memory, bytes a second
    std::vector<double> download; ///< host's time of a download into ordinary memory, bytes a second
    std::vector<double> launch;   ///< a launch of nothing and the wait for it, seconds
    std::vector<double> launch_queued; ///< one of many launches of nothing in a row, seconds
    std::vector<double>
        launch_timed;               ///< device's time of a launch of nothing with a clock around it, seconds
    std::vector<double> overlaps8;  ///< k-DOP overlap tests from registers a second, k = 8, float
    std::vector<double> overlaps18; ///< the same with k = 18
};

/// Bytes of the buffer that cache_read is of.
std::size_t cached_bytes(const DeviceInfo& info);

/// Measures a device; takes a second or so. May throw DeviceError.
Ceilings measure_ceilings(Device& device);

/// One record of results/ceilings.schema.json, of a device that they were measured of.
nlohmann::ordered_json ceilings_record(const Device& device, const Ceilings& ceilings);

/// The medians as lines of text.
std::string ceilings_table(const DeviceInfo& info, const Ceilings& ceilings);

} // namespace tandem
