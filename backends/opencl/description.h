// SPDX-License-Identifier: MIT
// The devices that the loader lists, and their properties.
#pragma once

#include "backends/device.h"
#include "backends/opencl/cl.h"

#include <string>
#include <vector>

namespace tandem::opencl {

/// A property of type T; zero when the driver does not report it.
template<class T>
T device_value(cl_device_id device, cl_device_info what) {
    T value{};
    clGetDeviceInfo(device, what, sizeof(T), &value, nullptr);
    return value;
}

/// Whether the driver lists the extension `name`.
bool has_extension(cl_device_id device, std::string_view name);

/// The properties of a device; `id` becomes `info.id`.
DeviceInfo describe(cl_device_id device, std::string id);

/// Every device of every platform, in the loader's order, or one sentence on why there is none.
struct Listing {
    std::vector<cl_device_id> devices;
    std::string reason; ///< empty when there are devices
};

Listing list_devices();

} // namespace tandem::opencl
