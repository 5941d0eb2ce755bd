// SPDX-License-Identifier: MIT
#include "backends/cuda/nvml.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <type_traits>

namespace tandem::cuda {

namespace {

/// The value that `call` writes to its last argument; empty when the library lacks the call or it fails.
template<class Value, class... Parameters, class... Arguments>
std::optional<Value> answer(NvmlResult (*call)(Parameters...), Arguments... arguments) {
    Value value{};
    if (call == nullptr || call(arguments..., &value) != 0) return std::nullopt;
    return value;
}

std::optional<double> watts(std::optional<unsigned> milliwatts) {
    if (!milliwatts) return std::nullopt;
    return *milliwatts / 1000.0;
}

} // namespace

Nvml::Nvml(std::span<const std::string> names) {
    const auto library = library_if_any(names); // which stays loaded
    if (!library) return;
    const auto load = [&](auto*& entry, const char* name) {
        entry = reinterpret_cast<std::remove_reference_t<decltype(entry)>>(library->find(name));
    };
#define TANDEM_LOAD(name, arguments) load(name, #name);
    TANDEM_NVML_ENTRIES(TANDEM_LOAD)
#undef TANDEM_LOAD
    started_ = nvmlInit_v2 != nullptr && nvmlInit_v2() == 0;
}

NvmlHandle Nvml::find(const std::string& hardware) const {
    if (!started_) return nullptr;
    auto* const call =
        hardware.starts_with("GPU-") ? nvmlDeviceGetHandleByUUID : nvmlDeviceGetHandleByPciBusId_v2;
    return answer<NvmlHandle>(call, hardware.c_str()).value_or(nullptr);
}

GpuCondition Nvml::read(NvmlHandle gpu) const {
    GpuCondition c;
    c.sm_mhz = answer<unsigned>(nvmlDeviceGetClockInfo, gpu, nvml_clock_sm);
    c.sm_limit_mhz = answer<unsigned>(nvmlDeviceGetMaxClockInfo, gpu, nvml_clock_sm);
    c.memory_mhz = answer<unsigned>(nvmlDeviceGetClockInfo, gpu, nvml_clock_memory);
    c.memory_limit_mhz = answer<unsigned>(nvmlDeviceGetMaxClockInfo, gpu, nvml_clock_memory);
    c.temperature_c = answer<unsigned>(nvmlDeviceGetTemperature, gpu, nvml_temperature_gpu);
    c.power_w = watts(answer<unsigned>(nvmlDeviceGetPowerUsage, gpu));
    c.power_limit_w = watts(answer<unsigned>(nvmlDeviceGetEnforcedPowerLimit, gpu));
    auto* const reasons = nvmlDeviceGetCurrentClocksThrottleReasons != nullptr
                              ? nvmlDeviceGetCurrentClocksThrottleReasons
                              : nvmlDeviceGetCurrentClocksEventReasons;
    c.throttle = answer<unsigned long long>(reasons, gpu);
    if (const auto use = answer<NvmlUtilization>(nvmlDeviceGetUtilizationRates, gpu))
        c.busy_percent = use->gpu;
    c.processes = other_processes(gpu);
    return c;
}

/// Does not count this process, which is listed because of its context. Its id is not compared: in a
/// container the listed id may be another.
std::optional<unsigned> Nvml::other_processes(NvmlHandle gpu) const {
    auto* const call = nvmlDeviceGetComputeRunningProcesses_v3 != nullptr
                           ? nvmlDeviceGetComputeRunningProcesses_v3
                           : nvmlDeviceGetComputeRunningProcesses_v2;
    std::array<NvmlProcess, 64> list;
    auto count = static_cast<unsigned>(list.size());
    const auto code = call == nullptr ? -1 : call(gpu, &count, list.data());
    if (code == nvml_insufficient_size) return count - 1; // more than fit; some may be listed twice
    if (code != 0) return std::nullopt;
    const auto by_id = [](const NvmlProcess& a, const NvmlProcess& b) { return a.id < b.id; };
    const auto same = [](const NvmlProcess& a, const NvmlProcess& b) { return a.id == b.id; };
    const auto last = list.begin() + std::min<std::ptrdiff_t>(count, std::ssize(list));
    std::sort(list.begin(), last, by_id);
    const auto distinct = std::unique(list.begin(), last, same) - list.begin();
    return static_cast<unsigned>(std::max<std::ptrdiff_t>(distinct - 1, 0));
}

std::optional<std::string> Nvml::driver() const {
    std::array<char, 80> text{}; // NVML_SYSTEM_DRIVER_VERSION_BUFFER_SIZE
    if (!started_ || nvmlSystemGetDriverVersion == nullptr
        || nvmlSystemGetDriverVersion(text.data(), static_cast<unsigned>(text.size()) - 1) != 0)
        return std::nullopt;
    return text.data();
}

std::shared_ptr<const Nvml> nvml() {
    static const auto loaded = [] {
        const auto* chosen = std::getenv("TANDEM_NVML");
        const std::array<std::string, 1> names{chosen != nullptr ? chosen : "libnvidia-ml.so.1"};
        return std::make_shared<const Nvml>(names);
    }();
    return loaded;
}

} // namespace tandem::cuda
