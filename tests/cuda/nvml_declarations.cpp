// SPDX-License-Identifier: MIT
// The adaptor's own declarations of NVML against its header; built if the header exists.
#include "backends/cuda/nvml.h"
#include "tests/cuda/callable_as.h"
#include "tests/support/test.h"

#define NVML_NO_UNVERSIONED_FUNC_DEFS // also declares older versions of calls
#include <cstddef>
#include <nvml.h>

namespace tandem {
namespace {

TEST(NvmlDeclarations, Entries) {
    using namespace tandem::cuda;
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#define TANDEM_COMPARE(name, arguments)                                                                      \
    EXPECT_TRUE(                                                                                             \
        callable_as(static_cast<int(*) arguments>(nullptr), static_cast<decltype(&::name)>(nullptr)))        \
        << #name;
    TANDEM_NVML_ENTRIES(TANDEM_COMPARE)
#undef TANDEM_COMPARE
}

TEST(NvmlDeclarations, Values) {
    EXPECT_EQ(0, int{NVML_SUCCESS});
    EXPECT_EQ(cuda::nvml_insufficient_size, int{NVML_ERROR_INSUFFICIENT_SIZE});
    EXPECT_EQ(int{cuda::nvml_clock_sm}, int{NVML_CLOCK_SM});
    EXPECT_EQ(int{cuda::nvml_clock_memory}, int{NVML_CLOCK_MEM});
    EXPECT_EQ(int{cuda::nvml_temperature_gpu}, int{NVML_TEMPERATURE_GPU});
    EXPECT_EQ(offsetof(cuda::NvmlProcess, id), offsetof(nvmlProcessInfo_t, pid));
    EXPECT_EQ(offsetof(cuda::NvmlUtilization, gpu), offsetof(nvmlUtilization_t, gpu));
}

TEST(NvmlDeclarations, ThrottleReasons) {
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonSwPowerCap),
              std::vector<std::string_view>{"power cap"});
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonHwSlowdown),
              std::vector<std::string_view>{"hardware slowdown"});
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonSyncBoost),
              std::vector<std::string_view>{"sync boost"});
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonSwThermalSlowdown),
              std::vector<std::string_view>{"heat (software)"});
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonHwThermalSlowdown),
              std::vector<std::string_view>{"heat (hardware)"});
    EXPECT_EQ(throttle_reasons(nvmlClocksThrottleReasonHwPowerBrakeSlowdown),
              std::vector<std::string_view>{"power brake"});
    EXPECT_TRUE(throttle_reasons(nvmlClocksThrottleReasonGpuIdle | nvmlClocksThrottleReasonUserDefinedClocks
                                 | nvmlClocksThrottleReasonDisplayClockSetting)
                    .empty());
}

} // namespace
} // namespace tandem
