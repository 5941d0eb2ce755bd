// SPDX-License-Identifier: MIT
// The entry points of NVIDIA's management library that tandem uses, declared in this file so that a build
// needs no toolkit. A test compares them with <nvml.h> when it is installed. Names and values: NVML API
// reference, R550.
#pragma once

#include "backends/gpu_condition.h"
#include "backends/library.h"

#include <optional>
#include <span>
#include <string>

namespace tandem::cuda {

using NvmlResult = int; ///< nvmlReturn_t; 0 is success
inline constexpr NvmlResult nvml_insufficient_size = 7;
using NvmlHandle = nvmlDevice_st*;

enum NvmlClock : int { nvml_clock_sm = 1, nvml_clock_memory = 2 }; ///< nvmlClockType_t
enum NvmlTemperature : int { nvml_temperature_gpu = 0 };           ///< nvmlTemperatureSensors_t

/// nvmlUtilization_t: percent of the last period.
struct NvmlUtilization {
    unsigned gpu = 0;
    unsigned memory = 0;
};

/// nvmlProcessInfo_t since version 2 of the call.
struct NvmlProcess {
    unsigned id = 0;
    unsigned long long memory = 0;
    unsigned gpu_instance = 0;
    unsigned compute_instance = 0;
};

// ENTRY(symbol in the library, arguments); each returns NvmlResult. Newer drivers name throttle reasons event
// reasons. The third version of the process list has the structure of the second.
#define TANDEM_NVML_ENTRIES(ENTRY)                                                                           \
    ENTRY(nvmlInit_v2, ())                                                                                   \
    ENTRY(nvmlSystemGetDriverVersion, (char*, unsigned))                                                     \
    ENTRY(nvmlDeviceGetHandleByUUID, (const char*, NvmlHandle*))                                             \
    ENTRY(nvmlDeviceGetHandleByPciBusId_v2, (const char*, NvmlHandle*))                                      \
    ENTRY(nvmlDeviceGetClockInfo, (NvmlHandle, NvmlClock, unsigned*))                                        \
    ENTRY(nvmlDeviceGetMaxClockInfo, (NvmlHandle, NvmlClock, unsigned*))                                     \
    ENTRY(nvmlDeviceGetTemperature, (NvmlHandle, NvmlTemperature, unsigned*))                                \
    ENTRY(nvmlDeviceGetPowerUsage, (NvmlHandle, unsigned*))                                                  \
    ENTRY(nvmlDeviceGetEnforcedPowerLimit, (NvmlHandle, unsigned*))                                          \
    ENTRY(nvmlDeviceGetCurrentClocksThrottleReasons, (NvmlHandle, unsigned long long*))                      \
    ENTRY(nvmlDeviceGetCurrentClocksEventReasons, (NvmlHandle, unsigned long long*))                         \
    ENTRY(nvmlDeviceGetUtilizationRates, (NvmlHandle, NvmlUtilization*))                                     \
    ENTRY(nvmlDeviceGetComputeRunningProcesses_v3, (NvmlHandle, unsigned*, NvmlProcess*))                    \
    ENTRY(nvmlDeviceGetComputeRunningProcesses_v2, (NvmlHandle, unsigned*, NvmlProcess*))

/// The NVML library, if any. No function throws; values that it lacks, refuses or does not support are empty.
/// It is never shut down: the driver does that when the process ends.
class Nvml {
public:
    /// Opens the first of `names` that loads, and initialises NVML.
    explicit Nvml(std::span<const std::string> names);

    /// The GPU with this UUID ("GPU-...") or PCI address; null when NVML lists none.
    NvmlHandle find(const std::string& hardware) const;
    GpuCondition read(NvmlHandle gpu) const;
    /// "550.54.15"; empty without NVML.
    std::optional<std::string> driver() const;

// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration
#define TANDEM_DECLARE(name, arguments) NvmlResult(*name) arguments = nullptr;
    TANDEM_NVML_ENTRIES(TANDEM_DECLARE)
#undef TANDEM_DECLARE

private:
    std::optional<unsigned> other_processes(NvmlHandle gpu) const;

    bool started_ = false;
};

/// $TANDEM_NVML or libnvidia-ml.so.1, opened at the first call.
std::shared_ptr<const Nvml> nvml();

} // namespace tandem::cuda
