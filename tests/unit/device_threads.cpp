// SPDX-License-Identifier: MIT
// Two host devices on two threads do not meet: work-group numbers, local memory and defines are the thread's.
#include "backends/host/host_device.h"
#include "tests/unit/device_support.h"

#include <barrier>
#include <numeric>
#include <thread>

namespace tandem {
namespace {

constexpr std::uint32_t levels = 7;
constexpr int rounds = 400;
constexpr std::size_t status_words = 1024; // more than a status has

/// Rows of counts, `pairs` and a place for the sum each, turned into starts by one work-group a row. The
/// number of pairs comes from the host or, with a define that the host reads at run time, from the device.
class Rows {
public:
    Rows(std::uint32_t pairs, bool counted_by_device) : pairs_(pairs) {
        kernel_ = test::compile(*device_, "scan_seeds", {{"BROAD_ON_DEVICE", counted_by_device ? "1" : "0"}});
        given_ = counted_by_device ? 2 * pairs : pairs;
        std::vector<std::uint32_t> status(status_words, 0); // counters of two words, low and high
        for (std::size_t i = 0; counted_by_device && i < status.size(); i += 2) status[i] = pairs;
        device_->upload(status_, bytes_of(status));
        counts_.resize(std::size_t{levels} * (pairs + 1));
        std::iota(counts_.begin(), counts_.end(), std::uint64_t{pairs});
        for (std::uint32_t level = 0; level < levels; ++level) {
            auto* row = counts_.data() + std::size_t{level} * (pairs + 1);
            row[pairs] = 0;
            auto& sums = sums_.emplace_back(pairs + 1);
            std::exclusive_scan(row, row + pairs + 1, sums.begin(), std::uint64_t{0});
        }
        seeds_ = device_->allocate(counts_.size() * 8, "seeds");
    }

    /// How many rows are wrong.
    std::size_t wrong() {
        device_->upload(seeds_, bytes_of(counts_));
        const std::array<Argument, 3> arguments{seeds_, given_, status_};
        device_->launch(kernel_, {levels, 1}, arguments);
        const auto starts = test::downloaded<std::uint64_t>(*device_, seeds_, counts_.size());
        std::size_t sum = 0;
        for (std::uint32_t level = 0; level < levels; ++level)
            sum += std::equal(sums_[level].begin(), sums_[level].end(),
                              starts.begin() + std::ptrdiff_t{level} * (pairs_ + 1))
                       ? 0
                       : 1;
        return sum;
    }

private:
    std::unique_ptr<Device> device_ = host::make_device();
    std::uint32_t pairs_;
    std::uint32_t given_ = 0;
    Kernel kernel_;
    Buffer status_ = device_->allocate(status_words * 4, "status");
    Buffer seeds_;
    std::vector<std::uint64_t> counts_;
    std::vector<std::vector<std::uint64_t>> sums_;
};

TEST(DeviceThreads, HostDevicesDoNotMeet) {
    Rows alone(50, true);
    ASSERT_EQ(alone.wrong(), 0u);
    std::barrier start(2);
    const auto run = [&](std::uint32_t pairs, bool counted_by_device, std::size_t& wrong) {
        Rows rows(pairs, counted_by_device);
        for (int i = 0; i < rounds; ++i) {
            start.arrive_and_wait();
            for (int j = 0; j < 100; ++j) wrong += rows.wrong();
        }
    };
    std::size_t here = 0;
    std::size_t there = 0;
    std::thread other([&] { run(90, true, there); });
    run(100, false, here);
    other.join();
    EXPECT_EQ(here, 0u);
    EXPECT_EQ(there, 0u);
}

} // namespace
} // namespace tandem
