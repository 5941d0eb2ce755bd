// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

struct nvmlDevice_st;

namespace tandem {

namespace cuda {
class Nvml;
}

/// What a GPU is like at one time, as its driver tells; what it does not tell is unknown.
struct GpuCondition {
    std::optional<unsigned> sm_mhz; ///< clock of the multiprocessors, and the highest that they have
    std::optional<unsigned> sm_limit_mhz;
    std::optional<unsigned> memory_mhz; ///< clock of the memory, and the highest that it has
    std::optional<unsigned> memory_limit_mhz;
    std::optional<unsigned> temperature_c;
    std::optional<double> power_w;       ///< drawn; newer GPUs tell the mean of the last second
    std::optional<double> power_limit_w; ///< enforced
    std::optional<std::uint64_t>
        throttle;                         ///< bits of NVML: why clocks are not higher, see throttle_reasons()
    std::optional<unsigned> busy_percent; ///< of the driver's last period in which kernels ran, whose ever
    std::optional<unsigned> processes;    ///< that compute on it beside this one

    bool operator==(const GpuCondition&) const = default;
};

/// What slows a GPU down, in words. Being idle and clocks that someone has set are in the bits too, but slow
/// nothing down that was not meant to be.
std::vector<std::string_view> throttle_reasons(std::uint64_t throttle);

/// Reads the condition of one device; made once for many readings. A reading asks the driver ten questions
/// and takes time on the host, so it belongs outside of every span that is timed. Never fails: of processors,
/// of GPUs of other vendors and without NVML everything is unknown.
class GpuGauge {
public:
    /// Finds the device by its `info.hardware`.
    explicit GpuGauge(const DeviceInfo& info);

    GpuCondition read() const;

private:
    std::shared_ptr<const cuda::Nvml> nvml_;
    nvmlDevice_st* handle_ = nullptr;
};

} // namespace tandem
