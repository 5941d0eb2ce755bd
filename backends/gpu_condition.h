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

/// The condition of a GPU at one time, as its driver reports it; values that it does not report are empty.
struct GpuCondition {
    std::optional<unsigned> sm_mhz; ///< clock of the multiprocessors, and its maximum
    std::optional<unsigned> sm_limit_mhz;
    std::optional<unsigned> memory_mhz; ///< clock of the memory, and its maximum
    std::optional<unsigned> memory_limit_mhz;
    std::optional<unsigned> temperature_c;
    std::optional<double> power_w;         ///< drawn; on newer GPUs the mean of the last second
    std::optional<double> power_limit_w;   ///< enforced
    std::optional<std::uint64_t> throttle; ///< bits of NVML, see throttle_reasons()
    std::optional<unsigned> busy_percent;  ///< of the driver's last period with kernels of any process
    std::optional<unsigned> processes;     ///< others that compute on it

    bool operator==(const GpuCondition&) const = default;
};

/// The reasons in these bits that slow a GPU down, as words. Idleness and clocks set on purpose are left out.
std::vector<std::string_view> throttle_reasons(std::uint64_t throttle);

/// Reads the condition of one device; create it once for many readings. A reading makes ten driver calls and
/// takes host time, so it belongs outside timed spans. Never fails: for processors, for GPUs of other vendors
/// and without NVML all values are empty.
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
