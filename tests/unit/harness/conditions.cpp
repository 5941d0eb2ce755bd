// SPDX-License-Identifier: MIT
// Conditions of the machine, read from folders that replace /proc and /sys.
#include "harness/sampling/conditions.h"
#include "harness/sampling/isolation/isolated_sampler.h"

#include "backends/hardware.h"
#include "backends/host/host_device.h"
#include "harness/sampling/control_group.h"
#include "harness/record/record.h"
#include "tests/support/folder.h"
#include "tests/support/test.h"

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tandem {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::Optional;

/// Condition of a processor of which only the core count is known.
ProcessorCondition processor_of_cores(unsigned cores) {
    ProcessorCondition condition;
    condition.cores = cores;
    return condition;
}

/// Condition of a GPU that other processes use, with the given throttle reasons.
GpuCondition shared_gpu(std::uint64_t throttle, unsigned processes) {
    GpuCondition condition;
    condition.throttle = throttle;
    condition.processes = processes;
    return condition;
}

/// A machine of four cores; this process may run on cores 0 and 2. Times in seconds.
class Conditions : public support::FolderTest {
protected:
    void write(const std::string& file, const std::string& text) const {
        const auto target = path(file);
        std::filesystem::create_directories(std::filesystem::path(target).parent_path());
        support::write_bytes(target, text);
    }

    /// `busy` seconds of `elapsed` on each of the two cores; the other two are busy all the time.
    void write_stat(double elapsed, double busy) const {
        const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
        std::string text = "cpu 1 2 3 4 5 6 7 8 9 10\n";
        for (int core = 0; core < 4; ++core) {
            const double part = (core % 2 == 0 ? busy : elapsed) * ticks / 4;
            const double rest = elapsed * ticks - 4 * part;
            // User, nice, system, idle, iowait, irq, softirq, steal, guest.
            text += fmt::format("cpu{} {:.0f} {:.0f} 0 {:.0f} {:.0f} 0 {:.0f} {:.0f} {:.0f} 0\n", core, part,
                                part, rest / 2, rest / 2, part, part, elapsed * ticks);
        }
        write("proc/stat", text + "intr 1 2 3\n");
    }

    ProcessorReader reader() {
        return ProcessorReader(path(""), [this] { return OwnUse{cores, own}; });
    }

    std::vector<unsigned> cores{0, 2};
    double own = 0;
};

TEST_F(Conditions, OwnWorkDoesNotCountAsOthers) {
    write_stat(1000, 100);
    auto processor = reader();
    own = 8;
    write_stat(1010, 104);
    const auto c = processor.read();
    EXPECT_EQ(c.cores, 2u);
    EXPECT_THAT(c.own, Optional(DoubleNear(0.8, 1e-9)));
    EXPECT_THAT(c.other_processes, Optional(DoubleNear(0, 1e-9)));
    EXPECT_EQ(disturbance({c, {}}, {c, {}}), std::nullopt);
}

TEST_F(Conditions, OthersAreCountedOnTheCoresOfThisProcess) {
    write_stat(1000, 100);
    auto processor = reader();
    const Condition before{processor.read(), {}};
    own = 4;
    write_stat(1010, 106);
    const Condition after{processor.read(), {}};
    EXPECT_EQ(before.processor.other_processes, std::nullopt) << "no time has passed";
    EXPECT_THAT(after.processor.other_processes, Optional(DoubleNear(0.8, 1e-9)));
    EXPECT_EQ(disturbance(before, after), "busy: other processes use 0.8 of 2 cores");
    EXPECT_EQ(disturbance(before, after, {.other_processes = 0.5}), std::nullopt);
}

TEST_F(Conditions, EachReadingStartsANewPeriod) {
    write_stat(1000, 100);
    auto processor = reader();
    write_stat(1010, 110);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2, 1e-9)));
    write_stat(1020, 110);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(0, 1e-9)));
}

TEST_F(Conditions, ShortPeriodsAreMerged) {
    write_stat(1000, 100);
    auto processor = reader();
    write_stat(1001, 101);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2, 1e-9)));
    write_stat(1001.12, 101);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2, 1e-9)))
        << "the period has not ended";
    write_stat(1001.24, 101.12);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2, 1e-9)));
    write_stat(1001.36, 101.24);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2 * 0.24 / 0.36, 1e-6)))
        << "over the whole period";
}

TEST_F(Conditions, WaitingForAnotherProcessIsLeftOut) {
    write_stat(1000, 100);
    auto processor = reader();
    own = 4;
    write_stat(1005, 102);
    ProcessorReader::leave_out(
        [&] {
            own = 5;
            write_stat(1025, 122);
        },
        path(""),
        [this] {
            return OwnUse{cores, own};
        });
    own = 9;
    write_stat(1030, 124.24);
    const auto c = processor.read();
    EXPECT_THAT(c.own, Optional(DoubleNear(0.8, 1e-9)));
    EXPECT_THAT(c.other_processes, Optional(DoubleNear(0.048, 1e-9)));
    // What follows counts again.
    write_stat(1040, 134.24);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(2, 1e-9)));
}

TEST_F(Conditions, ADifferentSetOfCoresRestartsThePeriod) {
    write_stat(1000, 100);
    auto processor = reader();
    cores = {0};
    write_stat(1010, 101);
    EXPECT_EQ(processor.read().other_processes, std::nullopt);
    write_stat(1020, 102);
    EXPECT_THAT(processor.read().other_processes, Optional(DoubleNear(0.1, 1e-9)));
    write_stat(900, 0); // another machine, as after the migration of a container
    EXPECT_EQ(processor.read().other_processes, std::nullopt);
}

TEST_F(Conditions, ClocksOfItsCores) {
    for (const auto& [core, governor, khz] :
         {std::tuple{0, "performance", 3000000}, {1, "powersave", 800000}, {2, "performance", 3500000}}) {
        const auto folder = fmt::format("sys/devices/system/cpu/cpu{}/cpufreq/", core);
        write(folder + "scaling_governor", fmt::format("{}\n", governor));
        write(folder + "scaling_cur_freq", fmt::format("{}\n", khz));
    }
    auto processor = reader();
    EXPECT_THAT(processor.read().governor, Optional(std::string("performance")));
    EXPECT_THAT(processor.read().mhz, Optional(3250));
    cores = {0, 1};
    EXPECT_THAT(processor.read().governor, Optional(std::string("mixed")));
    EXPECT_THAT(processor.read().mhz, Optional(1900));
}

TEST_F(Conditions, ClocksWithoutCpufreq) {
    std::string text;
    for (int core = 0; core < 4; ++core)
        text +=
            fmt::format("processor\t: {}\nmodel name\t: A 3 GHz\ncpu MHz\t\t: {}.5\n\n", core, 1000 + core);
    write("proc/cpuinfo", text);
    const auto c = reader().read();
    EXPECT_THAT(c.mhz, Optional(1001.5));
    EXPECT_EQ(c.governor, std::nullopt);
}

TEST_F(Conditions, PressureOfTheMachine) {
    write("proc/pressure/cpu",
          "some avg10=12.34 avg60=1.00 avg300=0.50 total=99\nfull avg10=0.00 avg60=0 avg300=0 total=0\n");
    EXPECT_THAT(reader().read().pressure, Optional(12.34));
}

TEST_F(Conditions, QuotaOfVersion2) {
    write("proc/self/cgroup", "0::/user.slice/unit.scope\n");
    write("sys/fs/cgroup/cpu.stat", "usage_usec 5\n");
    write("sys/fs/cgroup/user.slice/cpu.max", "300000 100000\n");
    write("sys/fs/cgroup/user.slice/cpu.stat",
          "usage_usec 5\nnr_periods 9\nnr_throttled 4\nthrottled_usec 8\n");
    write("sys/fs/cgroup/user.slice/unit.scope/cpu.max", "150000 100000\n");
    write("sys/fs/cgroup/cpu.max", "max 100000\n");
    write("sys/fs/cgroup/user.slice/unit.scope/cpu.stat", "nr_periods 0\nnr_throttled 1\n");
    const auto group = read_control_group(path(""));
    EXPECT_THAT(group.cores, Optional(1.5));
    EXPECT_THAT(group.throttled, Optional(5));

    auto processor = reader();
    EXPECT_THAT(processor.read().throttled, Optional(0));
    write("sys/fs/cgroup/user.slice/cpu.stat", "nr_throttled 7\n");
    const auto c = processor.read();
    EXPECT_THAT(c.throttled, Optional(3));
    EXPECT_THAT(c.quota, Optional(1.5));
    EXPECT_EQ(disturbance({}, {c, {}}), "quota: throttled 3 times");
    EXPECT_EQ(disturbance({}, {c, {}}, {.throttled = 3}), std::nullopt);
    EXPECT_THAT(processor.read().throttled, Optional(0)) << "since the last reading";
    write("sys/fs/cgroup/user.slice/cpu.stat", "nr_throttled 2\n");
    EXPECT_THAT(processor.read().throttled, Optional(0)) << "of another group";
}

TEST_F(Conditions, QuotaOfAContainerOfVersion1) {
    write("proc/self/cgroup", "12:cpuset:/\n4:cpu,cpuacct:/docker/4fff\n3:cpuacct:/docker/wrong\n");
    write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "200000\n");
    write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_period_us", "100000\n");
    write("sys/fs/cgroup/cpu,cpuacct/cpu.stat", "nr_periods 0\nnr_throttled 6\nthrottled_time 0\n");
    write("sys/fs/cgroup/cpuacct/cpu.stat", "nr_throttled 9\n"); // of another controller
    EXPECT_THAT(read_control_group(path("")).cores, Optional(2));
    EXPECT_THAT(read_control_group(path("")).throttled, Optional(6));
    write("sys/fs/cgroup/cpu,cpuacct/cpu.cfs_quota_us", "-1\n");
    EXPECT_EQ(read_control_group(path("")).cores, std::nullopt);
}

TEST_F(Conditions, MissingFilesGiveUnknown) {
    auto processor = reader();
    const auto c = processor.read();
    EXPECT_EQ(c, processor_of_cores(2));
    EXPECT_EQ(disturbance({c, {}}, {c, {}}), std::nullopt);
    EXPECT_EQ(condition_json({}).dump(), R"({"processor":{"cores":null,"quota_cores":null,"own_cores":null,)"
                                         R"("other_cores":null,"governor":null,"mhz":null,)"
                                         R"("throttled_periods":null,"pressure_percent":null},"gpus":[]})");
}

TEST_F(Conditions, InvalidContentGivesUnknown) {
    for (const auto* garbage :
         {"", "\n", ":", "cpu", "cpu0 x", "cpu0 1 2\ncpu2 1 2 3 4\n", "0:", "0::", "some nan",
          "some avg10=", "processor : -1\ncpu MHz : 5\n", "processor : 0\ncpu MHz : nan\n", "nr_throttled -",
          "max", "\xff\xfe 1 2 3", "1e999 1e999"}) {
        for (const auto* file :
             {"proc/stat", "proc/cpuinfo", "proc/pressure/cpu", "sys/fs/cgroup/cpu.max",
              "sys/fs/cgroup/cpu.stat", "sys/devices/system/cpu/cpu0/cpufreq/scaling_cur_freq"})
            write(file, garbage);
        for (const auto* groups : {garbage, "0::/\n"}) {
            write("proc/self/cgroup", groups);
            auto processor = reader();
            EXPECT_EQ(processor.read(), processor_of_cores(2)) << garbage;
        }
    }
}

TEST_F(Conditions, OfThisMachine) {
    const auto use = own_use();
    EXPECT_FALSE(use.cores.empty());
    EXPECT_GT(use.seconds, 0);
    const auto host = host::make_device();
    ConditionReader conditions({host.get()});
    const auto c = conditions.read();
    EXPECT_EQ(c.processor.cores, use.cores.size());
    EXPECT_THAT(c.gpus, ElementsAre(GpuCondition{})) << "the host is no GPU";
    EXPECT_TRUE(condition_json(c)["gpus"][0].is_null());
}

TEST(Disturbance, OfAGpu) {
    const Condition quiet{{}, {shared_gpu(0x103, 0)}};
    EXPECT_EQ(disturbance(quiet, quiet), std::nullopt) << "an idle GPU, and clocks set by a user";
    const Condition capped{{}, {shared_gpu(0x4, 0)}};
    EXPECT_EQ(disturbance(quiet, capped), "throttled: power cap");
    EXPECT_EQ(disturbance(capped, quiet), "throttled: power cap");
    Condition shared{processor_of_cores(4), {shared_gpu(0x4, 2)}};
    shared.processor.other_processes = 0.5;
    shared.processor.throttled = 1;
    EXPECT_EQ(disturbance(quiet, shared), "busy: other processes use 0.5 of 4 cores; quota: throttled once; "
                                          "throttled: power cap; other processes on the GPU: 2");
    EXPECT_EQ(disturbance(quiet, shared, {.other_processes = 1, .throttled = 1, .processes = 2}),
              "throttled: power cap");
}

TEST(Disturbance, NamesEveryReasonThatMatters) {
    EXPECT_THAT(throttle_reasons(~std::uint64_t{0}),
                ElementsAre("power cap", "hardware slowdown", "sync boost", "heat (software)",
                            "heat (hardware)", "power brake"));
    EXPECT_THAT(throttle_reasons(0x103), ElementsAre());
    for (const auto bit : {0x4u, 0x8u, 0x10u, 0x20u, 0x40u, 0x80u})
        EXPECT_EQ(throttle_reasons(bit).size(), 1u) << bit;
}

TEST(Disturbance, InJson) {
    const ProcessorCondition processor{.cores = 2,
                                       .quota = 1.5,
                                       .own = 0.98765,
                                       .other_processes = 0.0,
                                       .governor = "performance",
                                       .mhz = 2596.126,
                                       .throttled = 3,
                                       .pressure = 0.5};
    GpuCondition gpu;
    gpu.sm_mhz = 1980;
    gpu.power_w = 76.4321;
    gpu.throttle = 0x14;
    EXPECT_EQ(
        condition_json({processor, {gpu, {}}}).dump(),
        R"({"processor":{"cores":2,"quota_cores":1.5,"own_cores":0.988,"other_cores":0.0,)"
        R"("governor":"performance","mhz":2596.126,"throttled_periods":3,"pressure_percent":0.5},"gpus":[)"
        R"({"sm_mhz":1980,"sm_limit_mhz":null,"memory_mhz":null,"memory_limit_mhz":null,"temperature_c":null,)"
        R"("power_w":76.432,"power_limit_w":null,"throttle_bits":20,"throttled":["power cap","sync boost"],)"
        R"("busy_percent":null,"other_processes":null},null]})");
    EXPECT_EQ(gpu_condition_text(gpu), "1980 MHz SM, 76 W, throttled: power cap, sync boost");
    EXPECT_EQ(gpu_condition_text({}), "");
}

TEST(HardwareDigest, IsFnv1a) {
    // From the authors' list of test values.
    EXPECT_EQ(hardware_digest(""), "cbf29ce484222325");
    EXPECT_EQ(hardware_digest("a"), "af63dc4c8601ec8c");
    EXPECT_EQ(hardware_digest("foobar"), "85944171f73967e8");
}

TEST(HardwareDigest, ReplacesTheUuidInRecords) {
    DeviceInfo info;
    info.hardware = "GPU-5a5a5a5a-5a5a-5a5a-5a5a-5a5a5a5a5a5a";
    EXPECT_EQ(record_device(info)["hardware"], hardware_digest(info.hardware));
    EXPECT_EQ(record_device(info).dump().find("5a5a"), std::string::npos);
    EXPECT_TRUE(record_device({})["hardware"].is_null());
}

TEST(ConditionsJson, ReadingsAreArrays) {
    Condition quiet, busy, unknown;
    for (auto* condition : {&quiet, &busy}) {
        condition->processor.cores = 2;
        condition->gpus.resize(1);
        condition->gpus[0].sm_mhz = 1980;
        condition->gpus[0].throttle = 0;
    }
    busy.gpus[0].sm_mhz = 1200;
    busy.gpus[0].throttle = 4; // software power cap
    unknown.processor.cores = 2;
    unknown.gpus.resize(1);
    const auto alone = conditions_json(std::vector{quiet});
    EXPECT_EQ(alone["gpus"][0]["sm_mhz"], 1980);
    EXPECT_EQ(alone["gpus"][0]["throttled"], "");
    const auto three = conditions_json(std::vector{unknown, quiet, busy});
    EXPECT_EQ(three["processor"]["cores"], 2);
    EXPECT_EQ(three["gpus"][0]["sm_mhz"].dump(), "[null,1980,1200]");
    EXPECT_EQ(three["gpus"][0]["throttled"][1], "");
    EXPECT_FALSE(three["gpus"][0]["throttled"][2].get<std::string>().empty());
    EXPECT_TRUE(three["gpus"][0]["power_w"].is_null());
    EXPECT_EQ(conditions_json(std::vector{unknown, unknown})["gpus"].dump(), "[null]");
}

TEST(ConditionsOfAnotherProcess, ExcludeThisProcess) {
    const auto of = [](std::optional<unsigned> processes) {
        Condition condition;
        condition.gpus.resize(1);
        condition.gpus[0].processes = processes;
        return condition;
    };
    std::vector<RoundConditions> rounds{{2, of(3), of(3)}, {3, of(1), of(0)}, {4, of({}), of(2)}};
    leave_out_this_process(rounds, 3);
    std::vector<std::optional<unsigned>> left;
    for (const auto& round : rounds)
        for (const auto* condition : {&round.before, &round.after})
            left.push_back(condition->gpus[0].processes);
    EXPECT_EQ(left, (std::vector<std::optional<unsigned>>{3, 3, 0, 0, {}, 1}));
}

} // namespace
} // namespace tandem
