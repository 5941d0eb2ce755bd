// SPDX-License-Identifier: MIT
// A libnvidia-ml.so.1 without a GPU, or with the one of stub_driver.cpp. Variables select its answers:
// STUB_NVML_INIT (code of nvmlInit), STUB_SM, STUB_MEMORY_CLOCK (MHz), STUB_TEMPERATURE (C), STUB_POWER and
// STUB_POWER_LIMIT (mW), STUB_THROTTLE (bits), STUB_BUSY (percent), STUB_PROCESSES (compute processes,
// including this one) and STUB_REFUSES (names of unsupported calls). Compiled with STUB_OLD, it lacks the
// calls that old versions lack.
#include "backends/cuda/nvml.h"

#include <cstdlib>
#include <cstring>
#include <string_view>

using namespace tandem::cuda;

namespace {

constexpr NvmlResult not_supported = 3;
constexpr NvmlResult not_found = 6;

unsigned number(const char* name, unsigned otherwise) {
    const auto* text = std::getenv(name);
    return text != nullptr ? static_cast<unsigned>(std::atol(text)) : otherwise;
}

bool refuses(std::string_view call) {
    const auto* names = std::getenv("STUB_REFUSES");
    return names != nullptr && std::string_view(names).find(call) != std::string_view::npos;
}

char gpu; ///< the only GPU
NvmlHandle handle() { return reinterpret_cast<NvmlHandle>(&gpu); }

/// Answers `value`, except for another GPU or a refused call.
template<class Value>
NvmlResult answer(std::string_view call, NvmlHandle gpu_handle, Value* to, Value value) {
    if (gpu_handle != handle()) return not_found;
    if (refuses(call)) return not_supported;
    *to = value;
    return 0;
}

NvmlResult find(std::string_view call, std::string_view name, std::string_view known, NvmlHandle* found) {
    if (refuses(call) || name != known) return not_found;
    *found = handle();
    return 0;
}

NvmlResult processes(std::string_view call, NvmlHandle gpu_handle, unsigned* count, NvmlProcess* list) {
    const auto existing = number("STUB_PROCESSES", 1);
    if (const auto capacity = *count; capacity < existing) {
        *count = existing;
        return nvml_insufficient_size;
    }
    // Each process is listed twice, as if it had contexts in two instances of the GPU.
    const auto rows = 2 * existing <= *count ? 2 * existing : existing;
    for (unsigned i = 0; i < rows; ++i) list[i] = {.id = 1000 + i % existing};
    return answer(call, gpu_handle, count, rows);
}

} // namespace

extern "C" {
NvmlResult nvmlInit_v2() { return static_cast<NvmlResult>(number("STUB_NVML_INIT", 0)); }
NvmlResult nvmlSystemGetDriverVersion(char* text, unsigned size) {
    if (refuses(__func__)) return not_supported;
    std::strncpy(text, "550.54.15", size);
    return 0;
}
NvmlResult nvmlDeviceGetHandleByUUID(const char* uuid, NvmlHandle* found) {
    return find(__func__, uuid, "GPU-5a5a5a5a-5a5a-5a5a-5a5a-5a5a5a5a5a5a", found);
}
NvmlResult nvmlDeviceGetHandleByPciBusId_v2(const char* address, NvmlHandle* found) {
    return find(__func__, address, "00000000:5A:00.0", found);
}
NvmlResult nvmlDeviceGetClockInfo(NvmlHandle gpu_handle, NvmlClock clock, unsigned* mhz) {
    return answer(__func__, gpu_handle, mhz,
                  clock == nvml_clock_sm ? number("STUB_SM", 1980) : number("STUB_MEMORY_CLOCK", 3201));
}
NvmlResult nvmlDeviceGetMaxClockInfo(NvmlHandle gpu_handle, NvmlClock clock, unsigned* mhz) {
    return answer(__func__, gpu_handle, mhz, clock == nvml_clock_sm ? 1981u : 3202u);
}
NvmlResult nvmlDeviceGetTemperature(NvmlHandle gpu_handle, NvmlTemperature, unsigned* celsius) {
    return answer(__func__, gpu_handle, celsius, number("STUB_TEMPERATURE", 34));
}
NvmlResult nvmlDeviceGetPowerUsage(NvmlHandle gpu_handle, unsigned* milliwatts) {
    return answer(__func__, gpu_handle, milliwatts, number("STUB_POWER", 76400));
}
NvmlResult nvmlDeviceGetEnforcedPowerLimit(NvmlHandle gpu_handle, unsigned* milliwatts) {
    return answer(__func__, gpu_handle, milliwatts, number("STUB_POWER_LIMIT", 700000));
}
NvmlResult nvmlDeviceGetUtilizationRates(NvmlHandle gpu_handle, NvmlUtilization* use) {
    return answer(__func__, gpu_handle, use, NvmlUtilization{number("STUB_BUSY", 0), 0});
}
#ifdef STUB_OLD
NvmlResult nvmlDeviceGetComputeRunningProcesses_v2(NvmlHandle gpu_handle, unsigned* count,
                                                   NvmlProcess* list) {
    return processes(__func__, gpu_handle, count, list);
}
#else
NvmlResult nvmlDeviceGetComputeRunningProcesses_v3(NvmlHandle gpu_handle, unsigned* count,
                                                   NvmlProcess* list) {
    return processes(__func__, gpu_handle, count, list);
}
NvmlResult nvmlDeviceGetCurrentClocksThrottleReasons(NvmlHandle gpu_handle, unsigned long long* bits) {
    return answer(__func__, gpu_handle, bits, 0ull + number("STUB_THROTTLE", 1));
}
#endif
}
