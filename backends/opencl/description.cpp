// SPDX-License-Identifier: MIT
#include "backends/opencl/description.h"

#include "backends/hardware.h"

#include <array>
#include <fmt/format.h>
#include <mutex>

namespace tandem::opencl {

namespace {

std::string device_text(cl_device_id device, cl_device_info what) {
    std::size_t size = 0;
    clGetDeviceInfo(device, what, 0, nullptr, &size);
    std::string text(size, '\0');
    clGetDeviceInfo(device, what, size, text.data(), nullptr);
    while (!text.empty() && (text.back() == '\0' || text.back() == ' ')) text.pop_back();
    return text;
}

/// The UUID of the hardware (cl_khr_device_uuid), to recognise a GPU that two backends list.
std::string hardware_id(cl_device_id device) {
    constexpr cl_device_info uuid = 0x106A; // CL_DEVICE_UUID_KHR
    if (!has_extension(device, "cl_khr_device_uuid")) return {};
    return uuid_text(device_value<std::array<unsigned char, 16>>(device, uuid));
}

std::vector<cl_device_id> devices_of(cl_platform_id platform) {
    cl_uint count = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) return {};
    std::vector<cl_device_id> devices(count);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, devices.data(), nullptr);
    return devices;
}

} // namespace

bool has_extension(cl_device_id device, std::string_view name) {
    return device_text(device, CL_DEVICE_EXTENSIONS).find(name) != std::string::npos;
}

DeviceInfo describe(cl_device_id device, std::string id) {
    DeviceInfo info;
    info.id = std::move(id);
    info.name = device_text(device, CL_DEVICE_NAME);
    info.driver =
        fmt::format("{}, {}", device_text(device, CL_DEVICE_VERSION), device_text(device, CL_DRIVER_VERSION));
    info.compiler = device_text(device, CL_DEVICE_OPENCL_C_VERSION);
    info.hardware = hardware_id(device);
    info.is_gpu = (device_value<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) != 0;
    info.compute_units = device_value<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
    info.clock_mhz = device_value<cl_uint>(device, CL_DEVICE_MAX_CLOCK_FREQUENCY);
    info.max_group_size =
        static_cast<std::uint32_t>(device_value<std::size_t>(device, CL_DEVICE_MAX_WORK_GROUP_SIZE));
    info.global_bytes = device_value<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
    info.max_allocation = device_value<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
    info.local_bytes = device_value<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE);
    info.allocates_late = true; // the standard allows it, and GPU drivers do
    info.has_double = device_value<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG) != 0;
    return info;
}

Listing list_devices() {
    // While one thread initialises PoCL by the first call, it has no devices for other threads.
    static std::mutex mutex;
    const std::scoped_lock lock(mutex);
    Listing listing;
    cl_uint count = 0;
    const auto code = clGetPlatformIDs(0, nullptr, &count);
    if (code != CL_SUCCESS || count == 0) {
        listing.reason = fmt::format("opencl: no platform (the loader returned {}); install a driver, for a "
                                     "CPU the package pocl-opencl-icd",
                                     code);
        return listing;
    }
    std::vector<cl_platform_id> platforms(count);
    clGetPlatformIDs(count, platforms.data(), nullptr);
    for (auto* platform : platforms) {
        const auto devices = devices_of(platform);
        listing.devices.insert(listing.devices.end(), devices.begin(), devices.end());
    }
    if (listing.devices.empty()) listing.reason = fmt::format("opencl: {} platform(s), but no device", count);
    return listing;
}

} // namespace tandem::opencl
