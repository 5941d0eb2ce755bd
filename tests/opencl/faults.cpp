// SPDX-License-Identifier: MIT
// OpenCL calls that fail with work in flight: the resulting error, and that the device stays usable.
#include "backends/opencl/opencl_device.h"
#include "tests/opencl/shim.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

constexpr int out_of_resources = -5;

std::unique_ptr<Device> open_device() { return std::move(opencl::discover().devices.front()); }

enum class Outcome { works, fails, has_no_memory };

template<class Call>
Outcome outcome(int code, const Call& call) {
    opencl_shim_fail(1, code);
    auto result = Outcome::works;
    try {
        call();
    } catch (const OutOfMemory&) {
        result = Outcome::has_no_memory;
    } catch (const DeviceError&) {
        result = Outcome::fails;
    }
    opencl_shim_fail(0, 0);
    return result;
}

TEST(OpenclFaults, CodesOfOutOfMemory) {
    const auto device = open_device();
    const StageScope scope(*device, Stage::write);
    for (const int code : {-4, -5, -6, -61})
        EXPECT_EQ(outcome(code, [&] { device->allocate(64, "words"); }), Outcome::has_no_memory) << code;
    EXPECT_EQ(outcome(-34, [&] { device->allocate(64, "words"); }), Outcome::fails);
    EXPECT_EQ(device->bytes_allocated(), 0u);
    const auto words = device->allocate(64, "words");
    // Memory allocated at first use can make any command fail.
    EXPECT_EQ(outcome(-4, [&] { device->clear(words, 64); }), Outcome::has_no_memory);
    EXPECT_EQ(outcome(-5, [&] { device->clear(words, 64); }), Outcome::fails);
    device->clear(words, 64);
    EXPECT_EQ(unit_test::downloaded<std::uint32_t>(*device, words, 16), std::vector<std::uint32_t>(16, 0));
}

// One vendor reports 256 for kernels that it compiled for groups of 992 and can run in them.
TEST(OpenclFaults, ACompiledGroupSizeOverridesTheReportedMaximum) {
    const auto device = open_device();
    const StageScope scope(*device, Stage::write);
    const auto words = device->allocate(64, "words");
    const std::array<Argument, 1> arguments{words};
    opencl_shim_report_group_size(16);
    const auto kernel = unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "64"}});
    opencl_shim_report_group_size(0);
    device->launch(kernel, {4, 64}, arguments);
    EXPECT_THROW(device->launch(kernel, {4, 65}, arguments), DeviceError);
    device->finish();
}

// PoCL's cache makes one of several processes fail that build the same program at once.
TEST(OpenclFaults, ABuildThatFailsOnceIsRepeated) {
    const auto device = open_device();
    const StageScope scope(*device, Stage::write);
    const auto words = device->allocate(64, "words");
    const std::array<Argument, 1> arguments{words};
    opencl_shim_fail_builds(1);
    const auto kernel = unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "32"}});
    device->launch(kernel, {1, 32}, arguments);
    device->finish();
    opencl_shim_fail_builds(2);
    EXPECT_THAT(
        unit_test::message_of([&] {
            unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "16"}});
        }),
        testing::AllOf(testing::HasSubstr("does not compile with"), testing::EndsWith("no build log")));
    opencl_shim_fail_builds(0);
}

/// Every kind of command, with blocking and other uploads; returns the final words.
std::vector<std::uint32_t> every_command(Device& device) {
    constexpr std::size_t count = std::size_t{1} << 18;
    const StageScope scope(device, Stage::write);
    const auto words = device.allocate(count * 4, "words");
    device.upload(words, bytes_of(std::vector<std::uint32_t>(count, 1)));
    device.clear(words, 32);
    const auto kernel = unit_test::compile(device, "do_nothing");
    const std::array<Argument, 1> arguments{words};
    device.launch(kernel, {4, 1}, arguments);
    device.upload(words, bytes_of(std::vector<std::uint32_t>{2, 3}));
    device.upload(words, bytes_of(std::vector<std::uint32_t>{4, 5}), 16, true);
    device.upload(words, bytes_of(std::vector<std::uint32_t>{6, 7}), 24);
    device.clear(words, count * 2, count * 2);
    device.upload(words, bytes_of(std::vector<std::uint32_t>(count / 4, 8)), count * 3);
    return unit_test::downloaded<std::uint32_t>(device, words, count);
}

class EveryCall : public testing::TestWithParam<Clocks> {};

TEST_P(EveryCall, FailsCleanly) {
    opencl_shim_fail(0, 0);
    const auto expected = every_command(*open_device());
    const auto calls = opencl_shim_calls();
    ASSERT_GT(calls, 12u);
    for (unsigned long call = 1; call < calls; ++call) {
        const auto device = open_device();
        device->set_clocks(GetParam());
        opencl_shim_fail(call, out_of_resources);
        EXPECT_THROW(every_command(*device), DeviceError) << call;
        opencl_shim_fail(0, 0);
        EXPECT_EQ(device->bytes_allocated(), 0u);
        device->finish();
        EXPECT_EQ(every_command(*device), expected) << call;
        const auto trace = device->finish();
        EXPECT_EQ(trace.events.size(), GetParam() == Clocks::on ? 9u : 0u);
        for (const auto& event : trace.events) EXPECT_GE(event.device_ns, 0) << event.label;
    }
}

TEST_P(EveryCall, LeavesADeviceThatCanBeDestroyed) {
    const auto run = [](Device& device) {
        every_command(device);
        const StageScope scope(device, Stage::write);
        const auto words = device.allocate(std::size_t{1} << 20, "in flight at the end");
        device.upload(words, bytes_of(std::vector<std::uint32_t>(std::size_t{1} << 18, 1)));
    };
    opencl_shim_fail(0, 0);
    run(*open_device());
    const auto calls = opencl_shim_calls();
    for (unsigned long call = 1; call <= calls; ++call) {
        const auto device = open_device();
        device->set_clocks(GetParam());
        opencl_shim_fail(call, out_of_resources);
        EXPECT_EQ(unit_test::message_of([&] { run(*device); }) == "no error", call == calls) << call;
    }
    opencl_shim_fail(0, 0);
}

INSTANTIATE_TEST_SUITE_P(OpenclFaults, EveryCall, testing::Values(Clocks::off, Clocks::on),
                         [](const auto& test) { return test.param == Clocks::on ? "timed" : "untimed"; });

} // namespace
} // namespace tandem
