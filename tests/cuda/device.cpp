// SPDX-License-Identifier: MIT
// The CUDA adaptor on the stub of the driver: the current context, the cost of a launch, and errors.
#include "tests/cuda/allocations.h"
#include "tests/cuda/stubbed.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

/// Runs every operation, and calls `after` after each.
template<class After>
void every_operation(Device& device, const After& after) {
    const auto done = [&](const char* name, auto operation) {
        operation();
        after(name);
    };
    const StageScope scope(device, Stage::traverse);
    Buffer words;
    Kernel kernel;
    std::vector<std::uint32_t> values(16, 1);
    done("allocate", [&] { words = device.allocate(64, "words"); });
    done("upload", [&] { device.upload(words, bytes_of(values)); });
    done("blocking upload", [&] { device.upload(words, bytes_of(values), 0, true); });
    done("clear", [&] { device.clear(words, 32); });
    done("download", [&] { device.download(words, std::as_writable_bytes(std::span(values))); });
    done("compile", [&] { kernel = unit_test::compile(device, "do_nothing"); });
    const std::array<Argument, 1> arguments{words};
    done("launch", [&] { device.launch(kernel, {2, 1}, arguments); });
    done("finish", [&] { device.finish(); });
    done("set_clocks", [&] { device.set_clocks(Clocks::on); });
    done("timed launch", [&] { device.launch(kernel, {2, 1}, arguments); });
    done("finish with times", [&] { EXPECT_EQ(device.finish().events.at(0).device_ns, 1000); });
    done("set_clocks off", [&] { device.set_clocks(Clocks::off); });
    done("free", [&] { words = {}; });
}

TEST_F(CudaDevice, LeavesTheCurrentContextAlone) {
    for (auto* before : {Context{}, other}) {
        make_current(before);
        every_operation(*device,
                        [&](const char* operation_name) { EXPECT_EQ(current(), before) << operation_name; });
        { const auto found = cuda::discover(); }
        EXPECT_EQ(current(), before) << "opened and closed";
    }
    make_current(other);
    device.reset();
    EXPECT_EQ(current(), other);
}

TEST_F(CudaDevice, CompilesFilesTogether) {
    const auto compilers = std::min(2U, device->info().compilers); // one on a machine with one processor
    setenv("STUB_COMPILERS", std::to_string(compilers).c_str(), 1);
    const StageScope scope(*device, Stage::traverse);
    const auto words = device->allocate(64, "words");
    const std::array<Argument, 1> arguments{words};
    device->compile_together([&] {
        const auto one = unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "1"}});
        unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "2"}});
        EXPECT_EQ(one.facts().max_group_size, -1) << "complete before it is needed";
        device->launch(one, {1, 1}, arguments);
        EXPECT_EQ(one.facts().max_group_size, 1024);
    });
    unsetenv("STUB_COMPILERS");
    const auto facts = device->take_kernels();
    ASSERT_EQ(facts.size(), 2u);
    EXPECT_EQ(facts[1].max_group_size, 1024);
    EXPECT_EQ(facts[1].defines.at("GROUP_SIZE"), "2");
}

TEST_F(CudaDevice, ReportsTheFirstErrorOfCompilersAtTheEnd) {
    setenv("STUB_BROKEN", "1", 1);
    bool ended = false;
    const auto compile = [&] { unit_test::compile(*device, "do_nothing"); };
    EXPECT_THROW(device->compile_together([&] {
        device->compile_together(compile);
        ended = true;
    }),
                 DeviceError);
    EXPECT_TRUE(ended);
    unsetenv("STUB_BROKEN");
    EXPECT_THROW(compile(), DeviceError); // it is not compiled twice
    EXPECT_TRUE(device->take_kernels().empty());
}

TEST_F(CudaDevice, AdoptedRunsOnTheGivenStreamOfTheGivenContext) {
    CUstream_st* stream = nullptr;
    make_current(other);
    entry<CUstream_st**, unsigned>("cuStreamCreate")(&stream, 0);
    const auto calls_with = entry_of_stub<unsigned long(CUstream_st*, Context)>("stub_calls");
    const auto all = entry_of_stub<unsigned long()>("stub_all_calls");
    const auto other_calls = all() - calls_with(stream, other);
    for (auto* before : {Context{}, other}) {
        make_current(before);
        auto adopted = cuda::adopt(other, stream);
        EXPECT_EQ(current(), before);
        every_operation(*adopted,
                        [&](const char* operation_name) { EXPECT_EQ(current(), before) << operation_name; });
        adopted.reset();
        EXPECT_EQ(current(), before);
    }
    EXPECT_GT(calls_with(stream, other), 20u);
    EXPECT_EQ(all() - calls_with(stream, other), other_calls);
}

TEST_F(CudaDevice, AnInvalidContextCannotBeAdopted) {
    EXPECT_THAT(unit_test::message_of([] { cuda::adopt(nullptr, nullptr); }),
                testing::HasSubstr("the context cannot be adopted: CUDA_ERROR_INVALID_CONTEXT"));
}

TEST_F(CudaDevice, FramesDoNotAllocate) {
    const StageScope scope(*device, Stage::traverse);
    const auto words = device->allocate(4096, "a buffer with a label that is long");
    const auto kernel = unit_test::compile(*device, "do_nothing");
    const std::array<Argument, 3> arguments{words, 1u, 2.0};
    std::vector<std::uint32_t> values(1024, 1);
    const auto frame = [&] {
        device->upload(words, bytes_of(values));
        { const HostWork work(*device, Stage::broad, "work with a label that is long"); }
        device->launch(kernel, {2, 1}, arguments);
        device->clear(words, 64);
        device->download(words, std::as_writable_bytes(std::span(values)));
        device->finish();
    };
    frame();
    const auto before = allocations();
    for (int i = 0; i < 1000; ++i) frame();
    EXPECT_EQ(allocations(), before);
}

TEST_F(CudaDevice, StartsAndStopsAProfiler) {
    const auto starts = entry_of_stub<unsigned long()>("stub_profiler_starts");
    const auto stops = entry_of_stub<unsigned long()>("stub_profiler_stops");
    const auto before = std::pair{starts(), stops()};
    device->profile(true);
    EXPECT_EQ(std::pair(starts(), stops()), std::pair(before.first + 1, before.second));
    device->profile(false);
    EXPECT_EQ(std::pair(starts(), stops()), std::pair(before.first + 1, before.second + 1));
    EXPECT_EQ(current(), nullptr);
}

/// Computed from the stub's attributes: 2 multiprocessors of capability 9.0 with 128 float lanes each (CUDA
/// C++ Programming Guide, table of arithmetic throughput); data on both edges of 3,201 MHz, 768 bytes wide.
TEST_F(CudaDevice, ReportsItsPeaks) {
    EXPECT_EQ(device->info().cores, 256u);
    EXPECT_EQ(device->info().clock_mhz, 1980u);
    EXPECT_EQ(device->info().peak_bytes_per_s, 4'916'736'000'000u);
}

TEST_F(CudaDevice, UnknownAttributesGiveUnknownValues) {
    setenv("STUB_UNKNOWN", "13", 1); // CU_DEVICE_ATTRIBUTE_CLOCK_RATE
    const auto without_clock = cuda::discover().devices.at(0)->info();
    setenv("STUB_UNKNOWN", "37", 1); // CU_DEVICE_ATTRIBUTE_GLOBAL_MEMORY_BUS_WIDTH
    const auto without_width = cuda::discover().devices.at(0)->info();
    unsetenv("STUB_UNKNOWN");
    EXPECT_EQ(without_clock.clock_mhz, 0u);
    EXPECT_EQ(without_clock.peak_bytes_per_s, device->info().peak_bytes_per_s);
    EXPECT_EQ(without_width.peak_bytes_per_s, 0u);
}

/// The stub reports 1,024 resident work-items of at most 2,048.
TEST_F(CudaDevice, ReportsTheOccupancyOfAKernel) {
    EXPECT_EQ(unit_test::compile(*device, "do_nothing", {{"GROUP_SIZE", "64"}}).facts().occupancy, 0.5);
}

/// A handler of the error may free memory that a command in flight reads.
TEST_F(CudaDevice, AnErrorWaitsForCommandsInFlight) {
    const auto waits = entry_of_stub<unsigned long()>("stub_waits");
    const StageScope scope(*device, Stage::traverse);
    const auto words = device->allocate(64, "words");
    const auto kernel = unit_test::compile(*device, "do_nothing");
    const std::array<Argument, 1> arguments{words};
    device->upload(words, bytes_of(std::vector<std::uint32_t>(16, 1)));
    const auto before = waits();
    setenv("STUB_LAUNCH", "700", 1);
    EXPECT_THROW(device->launch(kernel, {1, 1}, arguments), DeviceError);
    unsetenv("STUB_LAUNCH");
    EXPECT_EQ(waits(), before + 1);
    EXPECT_EQ(current(), nullptr);
}

TEST_F(CudaDevice, ArgumentsHaveALimit) {
    const StageScope scope(*device, Stage::traverse);
    const auto words = device->allocate(64, "words");
    const auto kernel = unit_test::compile(*device, "do_nothing");
    const std::vector<Argument> arguments(33, Argument(words));
    EXPECT_THAT(unit_test::message_of([&] {
                    device->launch(kernel, {1, 1}, arguments);
                }),
                testing::HasSubstr("'do_nothing' with 33 arguments; a launch takes at most 32"));
    device->launch(kernel, {1, 1}, std::span(arguments).first(32));
}

TEST_F(CudaDevice, OutOfMemoryIsDistinguished) {
    const StageScope scope(*device, Stage::traverse);
    const auto words = device->allocate(64, "words");
    const auto kernel = unit_test::compile(*device, "do_nothing");
    const std::array<Argument, 1> arguments{words};
    device->set_clocks(Clocks::on);
    device->launch(kernel, {1, 1}, arguments);
    setenv("STUB_MEMORY", "1000", 1);
    EXPECT_THROW(device->allocate(2000, "more"), OutOfMemory);
    setenv("STUB_LAUNCH", "2", 1);
    EXPECT_THROW(device->launch(kernel, {1, 1}, arguments), OutOfMemory);
    setenv("STUB_LAUNCH", "700", 1);
    try {
        device->launch(kernel, {1, 1}, arguments);
        ADD_FAILURE();
    } catch (const OutOfMemory&) {
        ADD_FAILURE();
    } catch (const DeviceError&) {}
    unsetenv("STUB_MEMORY");
    unsetenv("STUB_LAUNCH");
    device->launch(kernel, {1, 1}, arguments);
    const auto trace = device->finish();
    ASSERT_EQ(trace.events.size(), 3u); // two launches and the wait
    EXPECT_EQ(trace.events[1].ticket, 2u);
    EXPECT_EQ(trace.events[1].device_ns, 1000);
    device->set_clocks(Clocks::off);
}

} // namespace
} // namespace tandem
