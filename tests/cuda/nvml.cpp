// SPDX-License-Identifier: MIT
// Conditions of a GPU from NVML, on its stub: available, refused and missing values.
#include "backends/cuda/nvml.h"

#include "backends/hardware.h"
#include "harness/sampling/conditions.h"
#include "tests/cuda/stubbed.h"
#include "tests/support/test.h"

#include <chrono>
#include <nlohmann/json.hpp>

namespace tandem {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

constexpr auto uuid = "GPU-5a5a5a5a-5a5a-5a5a-5a5a-5a5a5a5a5a5a";
constexpr GpuCondition unknown{};

/// Sets an environment variable of the stub for a scope.
class Variable {
public:
    Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
    ~Variable() { unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

private:
    const char* name_;
};

cuda::Nvml library(const char* variable) {
    const std::array<std::string, 1> names{std::getenv(variable)};
    return cuda::Nvml(names);
}

GpuCondition condition(const cuda::Nvml& nvml) { return nvml.read(nvml.find(uuid)); }

DeviceInfo gpu_of(const std::string& hardware) {
    DeviceInfo info;
    info.is_gpu = true;
    info.hardware = hardware;
    return info;
}

TEST(Nvml, ReadsAllOfAGpu) {
    const auto nvml = library("TANDEM_NVML");
    EXPECT_THAT(nvml.driver(), Optional(std::string("550.54.15")));
    const GpuCondition expected{.sm_mhz = 1980,
                                .sm_limit_mhz = 1981,
                                .memory_mhz = 3201,
                                .memory_limit_mhz = 3202,
                                .temperature_c = 34,
                                .power_w = 76.4,
                                .power_limit_w = 700,
                                .throttle = 1,
                                .busy_percent = 0,
                                .processes = 0};
    EXPECT_EQ(condition(nvml), expected);
    EXPECT_EQ(nvml.read(nvml.find("00000000:5A:00.0")), expected) << "by PCI address";
    EXPECT_EQ(nvml.find("GPU-00000000-0000-0000-0000-000000000000"), nullptr);
    EXPECT_EQ(nvml.find("00000000:01:00.0"), nullptr);
    EXPECT_EQ(nvml.find(""), nullptr);
}

TEST(Nvml, FollowsChanges) {
    const auto nvml = library("TANDEM_NVML");
    const Variable clock("STUB_SM", "345"), memory("STUB_MEMORY_CLOCK", "1593"),
        heat("STUB_TEMPERATURE", "87"), power("STUB_POWER", "699900"), limit("STUB_POWER_LIMIT", "500000"),
        busy("STUB_BUSY", "97"), throttle("STUB_THROTTLE", "36"), processes("STUB_PROCESSES", "3");
    const auto c = condition(nvml);
    EXPECT_THAT(c.sm_mhz, Optional(345));
    EXPECT_THAT(c.memory_mhz, Optional(1593));
    EXPECT_THAT(c.temperature_c, Optional(87));
    EXPECT_THAT(c.power_w, Optional(699.9));
    EXPECT_THAT(c.power_limit_w, Optional(500));
    EXPECT_THAT(c.busy_percent, Optional(97));
    EXPECT_THAT(c.throttle, Optional(0x24));
    EXPECT_THAT(c.processes, Optional(2)) << "each is listed twice, and this process is excluded";
}

TEST(Nvml, CountsMoreProcessesThanItLists) {
    const auto nvml = library("TANDEM_NVML");
    const Variable processes("STUB_PROCESSES", "100");
    EXPECT_THAT(condition(nvml).processes, Optional(99));
    const Variable none("STUB_PROCESSES", "0");
    EXPECT_THAT(condition(nvml).processes, Optional(0)) << "in a container that lists none";
}

TEST(Nvml, RefusedValuesAreUnknown) {
    const auto nvml = library("TANDEM_NVML");
    const auto without = [&](const std::string& call) {
        const Variable refuses("STUB_REFUSES", call);
        return condition(nvml);
    };
    auto expected = condition(nvml);
    expected.power_w = std::nullopt;
    EXPECT_EQ(without("nvmlDeviceGetPowerUsage"), expected);
    expected = condition(nvml);
    expected.throttle = std::nullopt;
    EXPECT_EQ(without("nvmlDeviceGetCurrentClocksThrottleReasons"), expected);
    expected = condition(nvml);
    expected.processes = expected.busy_percent = std::nullopt;
    EXPECT_EQ(without("nvmlDeviceGetComputeRunningProcesses_v3,nvmlDeviceGetUtilizationRates"), expected);
    EXPECT_EQ(nvml.read(nullptr), unknown) << "a lost GPU";
    const Variable refuses("STUB_REFUSES", "nvmlDeviceGetHandleByUUID,nvmlSystemGetDriverVersion");
    EXPECT_EQ(nvml.find(uuid), nullptr);
    EXPECT_EQ(nvml.driver(), std::nullopt);
}

TEST(Nvml, MissingValuesAreUnknown) {
    const auto nvml = library("STUB_OLD_NVML");
    auto expected = condition(library("TANDEM_NVML"));
    expected.throttle = std::nullopt;
    EXPECT_EQ(condition(nvml), expected);
    const Variable processes("STUB_PROCESSES", "2");
    EXPECT_THAT(condition(nvml).processes, Optional(1)) << "by the second version of the call";
}

TEST(Nvml, AbsentOrBroken) {
    const std::array<std::string, 1> nowhere{"/nonexistent/libnvidia-ml.so.1"};
    for (const auto& nvml : {cuda::Nvml(nowhere), library("STUB_NOT_NVML")}) {
        EXPECT_EQ(nvml.find(uuid), nullptr);
        EXPECT_EQ(nvml.driver(), std::nullopt);
    }
    const Variable init("STUB_NVML_INIT", "9"); // NVML_ERROR_DRIVER_NOT_LOADED
    const auto nvml = library("TANDEM_NVML");
    EXPECT_EQ(nvml.find(uuid), nullptr);
    EXPECT_EQ(nvml.driver(), std::nullopt);
}

TEST(Nvml, GaugesKnowGpusOnly) {
    EXPECT_THAT(GpuGauge(gpu_of(uuid)).read().sm_mhz, Optional(1980));
    EXPECT_THAT(GpuGauge(gpu_of("00000000:5A:00.0")).read().sm_mhz, Optional(1980));
    EXPECT_EQ(GpuGauge(gpu_of("")).read(), unknown);
    EXPECT_EQ(GpuGauge(gpu_of("GPU-other")).read(), unknown);
    auto processor = gpu_of(uuid);
    processor.is_gpu = false;
    EXPECT_EQ(GpuGauge(processor).read(), unknown);
}

TEST_F(CudaDevice, IsReadBesideTheProcessor) {
    ConditionReader reader({device.get(), device.get()});
    const auto before = reader.read();
    ASSERT_EQ(before.gpus.size(), 2u);
    EXPECT_THAT(before.gpus[1].sm_mhz, Optional(1980));
    EXPECT_GT(before.processor.cores, 0u);
    const Variable throttle("STUB_THROTTLE", "4"), processes("STUB_PROCESSES", "3");
    auto after = reader.read();
    after.processor = {};
    EXPECT_EQ(disturbance(before, after),
              "throttled (device 1 of 2): power cap; other processes on the GPU (device 1 of 2): 2; "
              "throttled (device 2 of 2): power cap; other processes on the GPU (device 2 of 2): 2");
    const auto json = condition_json(after);
    EXPECT_EQ(json["gpus"][0]["throttled"].dump(), R"(["power cap"])");
    EXPECT_EQ(json["gpus"][0]["power_w"], 76.4);
}

/// Time that tandem adds to the driver's.
TEST(Nvml, ReadingCostsLittle) {
    const GpuGauge gauge(gpu_of(uuid));
    constexpr int readings = 1000;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < readings; ++i) ASSERT_TRUE(gauge.read().sm_mhz);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    RecordProperty("microseconds", std::to_string(seconds.count() / readings * 1e6));
    EXPECT_LT(seconds.count() / readings, 1e-3);
}

} // namespace
} // namespace tandem
