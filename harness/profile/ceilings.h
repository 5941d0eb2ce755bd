// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem {

/// The maximum rates of a device, as samples. Empty when the device has no such rate.
struct Ceilings {
    std::vector<double> copy;            ///< copy in device memory, bytes read plus written a second
    std::vector<double> read;            ///< read of device memory, bytes a second
    std::vector<double> cache_read;      ///< read of a buffer that fits the cache, bytes a second
    std::vector<double> upload_pinned;   ///< upload from page-locked memory, device time, bytes a second
    std::vector<double> upload_pageable; ///< blocking upload from ordinary memory, host time, bytes a second
    std::vector<double> download;        ///< download into ordinary memory, host time, bytes a second
    std::vector<double> launch;          ///< an empty launch and the wait for it, seconds
    std::vector<double> launch_queued;   ///< one of many empty launches in a row, seconds
    std::vector<double> launch_timed;    ///< device time of an empty launch that is timed alone, seconds
    std::vector<double> overlaps8;       ///< k-DOP overlap tests from registers a second, k = 8, float
    std::vector<double> overlaps18;      ///< the same with k = 18
};

/// The size in bytes of the buffer for Ceilings::cache_read.
std::size_t cached_bytes(const DeviceInfo& info);

/// Measures a device in about a second. May throw DeviceError.
Ceilings measure_ceilings(Device& device);

/// One record of results/ceilings.schema.json, for the device on which the ceilings were measured.
nlohmann::ordered_json ceilings_record(const Device& device, const Ceilings& ceilings);

/// The medians as lines of text.
std::string ceilings_table(const DeviceInfo& info, const Ceilings& ceilings);

} // namespace tandem
