// SPDX-License-Identifier: MIT
// The Device contract, on every available device; PoCL is required.
#include "backends/host/host_device.h"
#include "tests/unit/backends/device_support.h"

#include <gmock/gmock.h>
#include <numeric>

namespace tandem {
namespace {

using unit_test::devices;
using unit_test::message_of;

TEST(Registry, HasHostAndOpencl) {
    const auto backends = discover();
    ASSERT_EQ(backends.size(), 3u);
    EXPECT_EQ(backends[0].devices.size(), 1u);
    EXPECT_GE(backends[1].devices.size(), 1u) << backends[1].reason;
    EXPECT_EQ(backends[2].name, "cuda");
    // With devices, a reason can name a driver that fails beside them.
    for (const auto& backend : backends) EXPECT_FALSE(backend.devices.empty() && backend.reason.empty());
}

TEST(Device, CopiesUploadsAtOnceAndReadsBack) {
    for (auto* device : devices()) {
        const StageScope scope(*device, Stage::write);
        std::vector<std::uint32_t> values(1000);
        std::iota(values.begin(), values.end(), 7u);
        const auto buffer = device->allocate(4000, "numbers");
        device->upload(buffer, bytes_of(values));
        const auto kept = values;
        std::fill(values.begin(), values.end(), 0u);
        std::vector<std::uint32_t> back(1000);
        device->download(buffer, std::as_writable_bytes(std::span(back)));
        EXPECT_EQ(back, kept) << device->info().id;
        device->clear(buffer, 8, 4);
        device->download(buffer, std::as_writable_bytes(std::span(back)));
        EXPECT_EQ(back[0], kept[0]);
        EXPECT_EQ(back[1], 0u);
        EXPECT_EQ(back[2], 0u);
        EXPECT_EQ(back[3], kept[3]);
        device->finish();
    }
}

TEST(Device, TracesEveryCommandOnceUnderItsStage) {
    for (auto* device : devices()) {
        device->finish();
        device->set_clocks(Clocks::on);
        const auto buffer = device->allocate(64, "words");
        const std::vector<std::uint32_t> words(16, 1);
        {
            const StageScope scope(*device, Stage::seed);
            device->upload(buffer, bytes_of(words));
        }
        { const HostWork work(*device, Stage::broad, "thinking"); }
        std::vector<std::uint32_t> back(16);
        {
            const StageScope scope(*device, Stage::read);
            device->download(buffer, std::as_writable_bytes(std::span(back)));
        }
        const auto trace = device->finish();
        device->set_clocks(Clocks::off);
        ASSERT_EQ(trace.events.size(), 3u) << device->info().id;
        EXPECT_EQ(trace.events[0].stage, Stage::seed);
        EXPECT_EQ(trace.events[0].bytes, 64u);
        EXPECT_FALSE(trace.events[0].blocked);
        EXPECT_GE(trace.events[0].device_ns, 0);
        EXPECT_EQ(trace.events[1].command, Command::host_work);
        EXPECT_EQ(trace.events[1].stage, Stage::broad);
        EXPECT_EQ(trace.events[2].command, Command::download);
        EXPECT_TRUE(trace.events[2].blocked);
        EXPECT_TRUE(device->finish().events.empty());
    }
}

/// Message of the std::logic_error of `call`.
template<class Call>
std::string refusal_of(const Call& call) {
    try {
        call();
    } catch (const std::logic_error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Device, RefusesCommandsOutsideAnyStage) {
    for (auto* device : devices()) {
        const auto words = device->allocate(64, "words");
        const auto kernel = unit_test::compile(*device, "do_nothing");
        const std::array<Argument, 1> arguments{words};
        std::vector<std::uint32_t> values(16, 1);
        const auto bytes = std::as_writable_bytes(std::span(values));
        const auto expect_refused = [&] {
            EXPECT_THAT(refusal_of([&] { device->upload(words, bytes); }),
                        testing::HasSubstr("upload of 'words' outside any StageScope"));
            EXPECT_THAT(refusal_of([&] { device->download(words, bytes); }),
                        testing::HasSubstr("download of 'words' outside"));
            EXPECT_THAT(refusal_of([&] { device->clear(words, 64); }),
                        testing::HasSubstr("clear of 'words' outside"));
            EXPECT_THAT(refusal_of([&] {
                            device->launch(kernel, {1, 1}, arguments);
                        }),
                        testing::HasSubstr("launch of 'do_nothing' outside"));
        };
        for (const auto clocks : {Clocks::off, Clocks::on}) {
            device->set_clocks(clocks);
            expect_refused();
            {
                const StageScope scope(*device, Stage::write);
                device->upload(words, bytes);
            }
            expect_refused();
            EXPECT_EQ(device->finish().events.size(), clocks == Clocks::on ? 2u : 0u); // with the wait
        }
        device->set_clocks(Clocks::off);
    }
}

TEST(Device, TracesTheWaitUnderTheStageOfTheLastCommand) {
    for (auto* device : devices()) {
        device->set_clocks(Clocks::on);
        const auto words = device->allocate(64, "words");
        {
            const StageScope outer(*device, Stage::write);
            device->clear(words, 64);
            const StageScope scope(*device, Stage::seed);
            device->clear(words, 64);
        }
        { const HostWork work(*device, Stage::postprocess, "thinking"); }
        const auto trace = device->finish();
        device->set_clocks(Clocks::off);
        ASSERT_EQ(trace.events.size(), 4u) << device->info().id;
        EXPECT_EQ(trace.events[0].stage, Stage::write);
        EXPECT_EQ(trace.events[3].command, Command::wait);
        EXPECT_EQ(trace.events[3].stage, Stage::seed);
    }
}

TEST(Device, ReportsWhatDoesNotFit) {
    for (auto* device : devices()) {
        const auto too_much = device->info().max_allocation + 1;
        EXPECT_THROW(device->allocate(too_much, "everything"), OutOfMemory);
        EXPECT_THAT(message_of([&] { device->allocate(too_much, "everything"); }),
                    testing::AllOf(testing::HasSubstr(std::to_string(too_much)),
                                   testing::HasSubstr("everything"),
                                   testing::HasSubstr(std::to_string(device->info().max_allocation))));
        const auto small = device->allocate(16, "small");
        const std::vector<std::uint32_t> words(5, 0);
        EXPECT_THAT(message_of([&] { device->upload(small, bytes_of(words)); }),
                    testing::HasSubstr("exceeds buffer 'small'"));
    }
}

TEST(Device, CountsAllocatedBytes) {
    for (auto* device : devices()) {
        const auto before = device->bytes_allocated();
        {
            const auto buffer = device->allocate(4096, "page");
            EXPECT_EQ(device->bytes_allocated(), before + 4096);
        }
        EXPECT_EQ(device->bytes_allocated(), before);
    }
}

TEST(Device, NamesTheKernelThatDoesNotCompile) {
    for (auto* device : devices()) {
        const auto& source = kernel_source("algorithms/hierarchy/refit.cl");
        const Defines defines{
            {"K", "10"}, {"AXES", "0"}, {"PRECISION", "32"}, {"ROUNDING", "1"}, {"GROUP_SIZE", "1"}};
        const auto message = message_of([&] { device->compile(source, "refit_strips", defines); });
        EXPECT_THAT(message, testing::HasSubstr("refit.cl")) << device->info().id;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
}

TEST(Device, HostNamesTheValuesOfKThatAreCompiled) {
    const auto device = host::make_device();
    const auto message = message_of([&] { unit_test::compile(*device, "refit_strips", {{"K", "10"}}); });
    EXPECT_THAT(message,
                testing::ContainsRegex("K=10;.* k = ([0-9]+, )*8, ([0-9]+, )*18[;,].*TANDEM_HOST_K"));
    EXPECT_THAT(message, testing::Not(testing::HasSubstr("10,"))) << "it is only asked for";
}

} // namespace
} // namespace tandem
