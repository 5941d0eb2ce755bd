// SPDX-License-Identifier: MIT
// Two host devices on two threads are independent: work-group numbers, local memory and defines are
// thread-local.
#include "algorithms/kernels/status.clh"
#include "algorithms/kernels/sources.h"
#include "backends/host/host_device.h"
#include "base/error.h"
#include "tests/unit/backends/device_support.h"

#include <barrier>
#include <numeric>
#include <thread>

namespace tandem {
namespace {

constexpr std::uint32_t levels = 7;
constexpr int rounds = 400;

/// Rows of counts, `pairs` counts and a slot for the sum each; one work-group per row converts them to
/// starts.
class Rows {
public:
    explicit Rows(std::uint32_t pairs) : pairs_(pairs) {
        kernel_ = unit_test::compile(*device_, "scan_seeds", {});
        std::vector<std::uint32_t> status(STATUS_WORDS, 0);
        status[STATUS_BODY_PAIRS] = pairs;
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

    /// Number of wrong rows.
    std::size_t wrong() {
        device_->upload(seeds_, bytes_of(counts_));
        const std::array<Argument, 3> arguments{seeds_, 2 * pairs_, status_};
        device_->launch(kernel_, {levels, 1}, arguments);
        const auto starts = unit_test::downloaded<std::uint64_t>(*device_, seeds_, counts_.size());
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
    StageScope scope_{*device_, Stage::traverse};
    std::uint32_t pairs_;
    Kernel kernel_;
    Buffer status_ = device_->allocate(STATUS_WORDS * 4, "status");
    Buffer seeds_;
    std::vector<std::uint64_t> counts_;
    std::vector<std::vector<std::uint64_t>> sums_;
};

/// A vertex at the origin, moved by the second of several poses. The distance is a define that the host reads
/// at run time; the result must be that distance.
class Moved {
public:
    explicit Moved(bool exact) : distance_(exact ? 16 : 12) {
        kernel_ =
            device_->compile(kernel_source("algorithms/published/transform.cl"), "transform_vertices",
                             {{"PRECISION", "32"}, {"PLACEMENT", exact ? "1" : "0"}, {"GROUP_SIZE", "1"}});
        std::vector<float> poses(32);
        poses[12 + 3] = 12;
        poses[16 + 3] = 16;
        device_->upload(poses_, bytes_of(poses));
        device_->upload(bodies_, bytes_of(std::vector<std::uint32_t>{1}));
        device_->upload(vertices_, bytes_of(std::vector<float>(4)));
    }

    std::size_t wrong() {
        const std::array<Argument, 5> arguments{vertices_, world_, bodies_, poses_, 1u};
        device_->launch(kernel_, {1, 1}, arguments);
        return unit_test::downloaded<float>(*device_, world_, 4).front() == distance_ ? 0 : 1;
    }

private:
    std::unique_ptr<Device> device_ = host::make_device();
    StageScope scope_{*device_, Stage::traverse};
    float distance_;
    Kernel kernel_;
    Buffer poses_ = device_->allocate(32 * 4, "poses"), bodies_ = device_->allocate(4, "bodies"),
           vertices_ = device_->allocate(16, "vertices"), world_ = device_->allocate(16, "world");
};

/// Wrong answers of two threads that run concurrently, each with its own `Job`.
template<class Job, class First, class Second>
std::size_t wrong_at_once(const First& first, const Second& second) {
    std::barrier start(2);
    const auto run = [&](const auto& setting) {
        Job job(setting);
        std::size_t wrong = 0;
        for (int i = 0; i < rounds; ++i) {
            start.arrive_and_wait();
            for (int j = 0; j < 100; ++j) wrong += job.wrong();
        }
        return wrong;
    };
    std::size_t wrong_second = 0;
    std::thread other([&] { wrong_second = run(second); });
    const auto wrong_first = run(first);
    other.join();
    return wrong_first + wrong_second;
}

TEST(DeviceThreads, TooManyAreRefused) {
    const auto device = host::make_device();
    device->set_threads(most_threads);
    EXPECT_THROW(device->set_threads(most_threads + 1), InputError);
}

TEST(DeviceThreads, HostDevicesAreIndependent) {
    ASSERT_EQ(Rows(50).wrong(), 0u);
    EXPECT_EQ(wrong_at_once<Rows>(100u, 90u), 0u);
}

TEST(DeviceThreads, DefinesOfHostDevicesAreIndependent) {
    ASSERT_EQ(Moved(false).wrong() + Moved(true).wrong(), 0u);
    EXPECT_EQ(wrong_at_once<Moved>(false, true), 0u);
}

} // namespace
} // namespace tandem
