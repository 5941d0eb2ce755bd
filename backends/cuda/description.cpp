// SPDX-License-Identifier: MIT
#include "backends/cuda/description.h"

#include "backends/cuda/call_error.h"
#include "backends/cuda/modules.h"
#include "backends/hardware.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace tandem::cuda {

namespace {

/// Float additions and multiplications of a multiprocessor per clock, by compute capability (CUDA C++
/// Programming Guide 8 and 12, "Arithmetic Instructions"); 0: unknown.
std::uint32_t float_cores(int capability) {
    if (capability < 30) return capability == 21 ? 48 : 32;
    if (capability < 50) return 192;
    if (capability == 60 || (capability >= 70 && capability <= 80)) return 64;
    return capability <= 129 ? 128 : 0;
}

/// Queries of one device. Errors name it as far as `info` is known.
struct Queries {
    const Libraries& libraries;
    DeviceHandle handle;
    const DeviceInfo& info;

    void check(Result result, std::string_view call, std::string_view what) const {
        if (result != 0) throw_call_error(libraries, info, result, call, what);
    }
    int attribute(DeviceAttribute which) const {
        int value = 0;
        check(libraries.driver.cuDeviceGetAttribute(&value, which, handle), "cuDeviceGetAttribute",
              "querying the device's attributes");
        return value;
    }
    /// 0: the driver does not report it.
    int optional_attribute(DeviceAttribute which) const {
        int value = 0;
        return libraries.driver.cuDeviceGetAttribute(&value, which, handle) == 0 ? std::max(value, 0) : 0;
    }
};

/// Requires `info.compute_units`.
void describe_peaks(DeviceInfo& info, int capability, const Queries& queries) {
    info.cores = float_cores(capability) * info.compute_units;
    info.clock_mhz = static_cast<std::uint32_t>(queries.optional_attribute(clock_rate_khz)) / 1000;
    // Double data rate: two transfers per clock.
    info.peak_bytes_per_s = std::uint64_t{2000}
                            * static_cast<std::uint64_t>(queries.optional_attribute(memory_clock_rate_khz))
                            * (static_cast<std::uint64_t>(queries.optional_attribute(memory_bus_bits)) / 8);
}

} // namespace

Description describe(const Libraries& libraries, DeviceHandle handle, std::string id) {
    const auto& driver = libraries.driver;
    Description description;
    auto& [info, capability, threads_per_unit] = description;
    const Queries queries{libraries, handle, info};
    info.id = std::move(id);
    std::array<char, 256> text{};
    queries.check(driver.cuDeviceGetName(text.data(), static_cast<int>(text.size()), handle),
                  "cuDeviceGetName", "querying the device's name");
    info.name = text.data();
    std::array<unsigned char, 16> uuid{};
    if (driver.cuDeviceGetUuid_v2(uuid.data(), handle) == 0) info.hardware = uuid_text(uuid);
    capability = queries.attribute(capability_major) * 10 + queries.attribute(capability_minor);
    info.driver = fmt::format("CUDA {}{}", version_text(driver.version), kernel_driver());
    info.compiler = fmt::format("NVRTC {} for sm_{}", version_text(libraries.nvrtc.version()), capability);
    info.is_gpu = true;
    info.has_directed_rounding = true;
    info.compilers = compilers_at_once();
    info.stages_pinned = true;
    info.compute_units = static_cast<std::uint32_t>(queries.attribute(multiprocessor_count));
    info.max_group_size = static_cast<std::uint32_t>(queries.attribute(max_threads_per_block));
    info.local_bytes = static_cast<std::uint64_t>(queries.attribute(max_shared_per_block));
    describe_peaks(info, capability, queries);
    threads_per_unit = queries.attribute(max_threads_per_multiprocessor);
    std::size_t memory = 0;
    queries.check(driver.cuDeviceTotalMem_v2(&memory, handle), "cuDeviceTotalMem",
                  "querying the device's memory");
    info.global_bytes = info.max_allocation = memory;
    return description;
}

int device_count(const Driver& driver) {
    int count = 0;
    if (const auto code = driver.cuDeviceGetCount(&count); code != 0)
        throw DeviceError(fmt::format("cuda: cuDeviceGetCount failed with {}", driver.describe(code)));
    return count;
}

DeviceHandle device_handle(const Driver& driver, int index) {
    DeviceHandle handle = 0;
    if (const auto code = driver.cuDeviceGet(&handle, index); code != 0)
        throw DeviceError(fmt::format("cuda:{}: cuDeviceGet failed with {}", index, driver.describe(code)));
    return handle;
}

} // namespace tandem::cuda
