// SPDX-License-Identifier: MIT
// Errors of memory and of sizes, and their messages.
#include "tests/unit/backends/device_support.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

namespace tandem {
namespace {

using testing::HasSubstr;
using unit_test::devices;
using unit_test::message_of;

TEST(DeviceMemory, ALimitIsEnforcedAndReported) {
    for (auto* device : devices()) {
        ASSERT_EQ(device->memory_limit(), Device::no_memory_limit);
        const StageScope scope(*device, Stage::write);
        const auto held = device->allocate(4096, "held");
        const auto in_use = device->bytes_allocated();
        const auto limit = in_use + 1000;
        device->set_memory_limit(limit);
        EXPECT_EQ(device->memory_limit(), limit);
        EXPECT_THROW(device->allocate(1001, "too much"), OutOfMemory) << device->info().id;
        const auto message = message_of([&] { device->allocate(1001, "too much"); });
        EXPECT_THAT(message, testing::AllOf(HasSubstr("'too much' needs 1001 bytes"),
                                            HasSubstr(std::to_string(in_use) + " are in use"),
                                            HasSubstr("the limit is " + std::to_string(limit))));
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_EQ(device->allocate(1000, "all of it").bytes(), 1000u);
        device->set_memory_limit(10); // below what is allocated: allocations fail, existing buffers work
        EXPECT_THROW(device->allocate(1, "anything"), OutOfMemory);
        device->clear(held, 4096);
        device->set_memory_limit(Device::no_memory_limit);
        EXPECT_EQ(device->allocate(100000, "more").bytes(), 100000u);
        EXPECT_EQ(device->bytes_allocated(), in_use);
    }
}

TEST(DeviceMemory, AllocationsEndAtThePhysicalMemory) {
    for (auto* device : devices()) {
        const auto& info = device->info();
        if (!info.allocates_late) continue;
        std::vector<Buffer> held;
        const auto part = static_cast<std::size_t>(std::min(info.max_allocation, info.global_bytes / 4));
        const auto message = message_of([&] {
            while (device->bytes_allocated() <= info.global_bytes)
                held.push_back(device->allocate(part, "part"));
        });
        EXPECT_THAT(message,
                    testing::AllOf(HasSubstr("'part' needs " + std::to_string(part)),
                                   HasSubstr(std::to_string(device->bytes_allocated()) + " are in use"),
                                   HasSubstr("has " + std::to_string(info.global_bytes))));
        EXPECT_THROW(device->allocate(part, "part"), OutOfMemory) << info.id;
    }
}

#if !defined(__SANITIZE_ADDRESS__)
/// Returns 0 if the host's failing allocation throws OutOfMemory.
int allocate_in_a_small_process() {
    const auto device = std::move(discover().front().devices.front());
    const rlimit limit{std::size_t{1} << 30, std::size_t{1} << 30};
    setrlimit(RLIMIT_AS, &limit);
    try {
        device->allocate(std::size_t{1} << 30, "what does not fit");
    } catch (const OutOfMemory& error) {
        return std::string_view(error.what()).find("1073741824 bytes requested") != std::string_view::npos
                   ? 0
                   : 2;
    } catch (const std::exception&) {
        return 3;
    }
    return 4;
}

TEST(DeviceMemoryDeathTest, AFailedHostAllocationThrowsOutOfMemory) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(std::_Exit(allocate_in_a_small_process()), testing::ExitedWithCode(0), "");
}
#endif

#if !defined(__SANITIZE_ADDRESS__) // AddressSanitizer ends the program at such a write
/// Copies 64 bytes to the beginning of `to`, with a kernel that does not check the capacity.
void copy_eight_words(Device& device, const Buffer& to) {
    const StageScope scope(device, Stage::traverse);
    const auto from = device.allocate(64, "source");
    device.clear(from, 64);
    const std::array<Argument, 3> arguments{from, to, std::uint64_t{8}};
    device.launch(unit_test::compile(device, "copy_words"), {1, 1}, arguments);
}

std::string defect_of(Device& device) {
    try {
        device.check_guards();
    } catch (const std::logic_error& error) {
        return error.what();
    }
    return "none";
}

TEST(DeviceGuards, DetectWritesPastTheEnd) {
    for (const auto& backend : discover())
        for (const auto& device : backend.devices) {
            EXPECT_EQ(defect_of(*device), "none"); // guards are off
            device->guard_buffers();
            const auto sufficient = device->allocate(64, "sufficient");
            auto shorter = device->allocate(56, "shorter");
            EXPECT_EQ(device->bytes_allocated(), 120u);
            copy_eight_words(*device, sufficient);
            EXPECT_EQ(defect_of(*device), "none");
            const auto expected = device->info().id
                                  + ": a kernel wrote past the end of buffer 'shorter': byte 0 behind its 56 "
                                    "bytes has changed";
            copy_eight_words(*device, shorter);
            EXPECT_EQ(defect_of(*device), expected);
            EXPECT_EQ(defect_of(*device), "none"); // each write is reported once
            copy_eight_words(*device, shorter);
            shorter = {}; // growing frees a buffer before the frame ends
            EXPECT_EQ(defect_of(*device), expected);
            EXPECT_EQ(device->bytes_allocated(), 64u);
        }
}

TEST(DeviceGuards, AreNotTraced) {
    for (const auto& backend : discover())
        for (const auto& device : backend.devices) {
            device->guard_buffers();
            device->set_clocks(Clocks::on);
            for (int frame = 0; frame < 2; ++frame) {
                const auto words = device->allocate(64, "words");
                copy_eight_words(*device, words);
                device->check_guards();
                const auto trace = device->finish();
                ASSERT_EQ(trace.events.size(), 3u) << device->info().id; // clear, launch, and the wait
                EXPECT_EQ(trace.events[0].label, "source");
                EXPECT_EQ(trace.events[1].label, "copy_words");
                EXPECT_GE(trace.events[0].device_ns, 0);
                EXPECT_GE(trace.events[1].device_ns, 0);
                EXPECT_GE(trace.events[1].begin_ns, trace.events[0].begin_ns);
            }
        }
}
#endif

TEST(DeviceGroups, ThatAreTooLargeAreRefused) {
    for (auto* device : devices()) {
        const StageScope scope(*device, Stage::traverse);
        const auto kernel = unit_test::compile(*device, "do_nothing");
        const auto words = device->allocate(64, "words");
        const std::array<Argument, 1> arguments{words};
        const auto reported = kernel.facts().max_group_size;
        const auto most = reported >= 0 ? reported : std::int64_t{device->info().max_group_size};
        const auto wanted = static_cast<std::uint32_t>(most + 1);
        const auto message = message_of([&] { device->launch(kernel, {1, wanted}, arguments); });
        EXPECT_THAT(message, testing::AllOf(HasSubstr(device->info().id), HasSubstr("'do_nothing'"),
                                            HasSubstr("groups of " + std::to_string(wanted)),
                                            HasSubstr("the maximum is " + std::to_string(most))));
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_NE(message_of([&] { device->launch(kernel, {1, 0}, arguments); }), "no error");
        device->launch(kernel, {1, 1}, arguments);
        device->finish();
    }
}

} // namespace
} // namespace tandem
