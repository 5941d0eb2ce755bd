// SPDX-License-Identifier: MIT
// Helpers shared by the tests of the Device contract.
#pragma once

#include "algorithms/kernels/sources.h"
#include "backends/registry.h"

#include <gtest/gtest.h>

namespace tandem::unit_test {

/// All available devices.
inline std::vector<Device*> devices() {
    static const auto backends = discover();
    std::vector<Device*> all;
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) all.push_back(device.get());
    return all;
}

/// Message of the DeviceError of `call`.
template<class Call>
std::string message_of(const Call& call) {
    try {
        call();
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "no error";
}

/// The kernel of that name from any file, for groups of one work-item and default defines.
inline Kernel compile(Device& device, const std::string& entry, Defines defines = {}) {
    defines.merge(Defines{{"K", "8"}, {"AXES", "0"}, {"PRECISION", "32"}, {"GROUP_SIZE", "1"}});
    for (const auto& source : kernel_sources())
        if (source.text.find("KERNEL void " + entry + "(") != std::string_view::npos)
            return device.compile(source, entry, defines);
    throw DeviceError("no kernel " + entry);
}

template<class T>
std::vector<T> downloaded(Device& device, const Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    const StageScope scope(device, Stage::read);
    device.download(buffer, std::as_writable_bytes(std::span(values)));
    return values;
}

} // namespace tandem::unit_test
