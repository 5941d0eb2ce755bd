// SPDX-License-Identifier: MIT
#include "backends/gpu_condition.h"

#include "backends/cuda/nvml.h"

#include <array>
#include <utility>

namespace tandem {

std::vector<std::string_view> throttle_reasons(std::uint64_t throttle) {
    // NvmlClocksThrottleReasons of the NVML API reference. Not listed: idle (0x1), clocks set for
    // applications (0x2) and for displays (0x100).
    static constexpr std::array<std::pair<std::uint64_t, std::string_view>, 6> slowing{
        {{0x4, "power cap"},
         {0x8, "hardware slowdown"},
         {0x10, "sync boost"},
         {0x20, "heat (software)"},
         {0x40, "heat (hardware)"},
         {0x80, "power brake"}}};
    std::vector<std::string_view> reasons;
    for (const auto& [bit, name] : slowing)
        if ((throttle & bit) != 0) reasons.push_back(name);
    return reasons;
}

GpuGauge::GpuGauge(const DeviceInfo& info) {
    if (!info.is_gpu || info.hardware.empty()) return; // no GPU: NVML is not loaded
    nvml_ = cuda::nvml();
    handle_ = nvml_->find(info.hardware);
}

GpuCondition GpuGauge::read() const { return handle_ != nullptr ? nvml_->read(handle_) : GpuCondition{}; }

} // namespace tandem
