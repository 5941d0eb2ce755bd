// SPDX-License-Identifier: MIT
// Costs of the Device contract for an embedding application: nothing accumulates from frame to frame.
#include "tests/support/heap.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

using support::heap;

class Frames {
public:
    explicit Frames(Device& device) : device_(device), nothing_(unit_test::compile(device, "do_nothing")) {}

    void run(std::size_t count) {
        const StageScope scope(device_, Stage::traverse);
        const std::array<Argument, 1> arguments{words_};
        for (std::size_t i = 0; i < count; ++i) {
            device_.upload(words_, bytes_of(values_));
            device_.launch(nothing_, {2, 1}, arguments);
            { const HostWork work(device_, Stage::broad, "work of the host with a label that is long"); }
            device_.clear(words_, 64, 64);
            device_.download(words_, std::as_writable_bytes(std::span(values_)));
        }
    }

private:
    Device& device_;
    Kernel nothing_;
    Buffer words_ = device_.allocate(4096, "a buffer with a label that is long");
    std::vector<std::uint32_t> values_ = std::vector<std::uint32_t>(1024, 7);
};

TEST(DeviceCost, NothingIsKeptWithoutClocks) {
    for (auto* device : unit_test::devices()) {
        ASSERT_EQ(device->clocks(), Clocks::off);
        Frames frames(*device);
        frames.run(1000);
        const auto before = heap();
        frames.run(10000);
        const auto after = heap();
        EXPECT_LT(after, before + 200000) << device->info().id;
        EXPECT_TRUE(device->finish().events.empty()) << device->info().id;
        frames.run(1);
        device->set_clocks(Clocks::on);
        EXPECT_TRUE(device->finish().events.empty()) << device->info().id;
        device->set_clocks(Clocks::off);
    }
}

TEST(DeviceCost, SwitchingClocksDropsWhatWasRecorded) {
    for (auto* device : unit_test::devices()) {
        Frames frames(*device);
        device->set_clocks(Clocks::on);
        frames.run(3);
        device->set_clocks(Clocks::off);
        EXPECT_TRUE(device->finish().events.empty()) << device->info().id;
        device->set_clocks(Clocks::on);
        frames.run(2);
        const auto trace = device->finish();
        EXPECT_EQ(trace.events.size(), 10u) << device->info().id;
        for (const auto& event : trace.events)
            EXPECT_EQ(event.device_ns < 0, event.command == Command::host_work) << device->info().id;
        device->set_clocks(Clocks::off);
    }
}

/// Without a bound, 300 MiB in flight would need 300 MiB of copies. An upload that waits for staging memory
/// is traced as blocked.
TEST(DeviceCost, CopiesOfUploadsAreBounded) {
    constexpr std::size_t words = std::size_t{1} << 18;
    for (auto* device : unit_test::devices()) {
        const StageScope scope(*device, Stage::write);
        const auto buffer = device->allocate(words * 4, "a MiB");
        device->set_clocks(Clocks::on);
        const auto before = heap();
        std::vector<std::uint32_t> values(words);
        for (std::uint32_t i = 0; i < 300; ++i) {
            values.front() = values.back() = i;
            device->upload(buffer, bytes_of(values));
        }
        EXPECT_LT(heap(), before + (std::size_t{100} << 20)) << device->info().id;
        EXPECT_EQ(unit_test::downloaded<std::uint32_t>(*device, buffer, words), values);
        std::size_t waits = 0;
        for (const auto& event : device->finish().events)
            waits += event.command == Command::upload && event.blocked ? 1 : 0;
        EXPECT_EQ(waits > 0, device->info().id != "host") << device->info().id;
        device->set_clocks(Clocks::off);
    }
}

TEST(DeviceCost, KernelPropertiesAreReportedOnce) {
    for (auto* device : unit_test::devices()) {
        for (int i = 0; i < 3; ++i) unit_test::compile(*device, "do_nothing");
        const auto facts = device->take_kernels();
        EXPECT_EQ(std::count_if(facts.begin(), facts.end(), [](auto& f) { return f.entry == "do_nothing"; }),
                  1)
            << device->info().id;
        EXPECT_TRUE(device->take_kernels().empty());
        unit_test::compile(*device, "do_nothing");
        const auto again = device->take_kernels();
        ASSERT_EQ(again.size(), 1u);
        EXPECT_EQ(again[0].compile_ms, 0);
    }
}

} // namespace
} // namespace tandem
