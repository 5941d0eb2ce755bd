// SPDX-License-Identifier: MIT
// Estimated device speeds, and when bodies should be repartitioned.
#include "algorithms/distributed/load_balancer.h"
#include "tests/support/test.h"

#include <random>

namespace tandem {
namespace {

DeviceWork work_of(std::int64_t ns) { return {.bodies = 1, .body_pairs = 1, .pairs = 1, .ns = ns}; }

TEST(LoadBalancer, RepartitionsAfterSeveralImbalancedFrames) {
    LoadBalancer balancer(2);
    const std::array work{100.0, 100.0};
    const std::array even{work_of(100), work_of(104)}, odd{work_of(100), work_of(300)};
    EXPECT_DOUBLE_EQ(imbalance(odd), 1.5);
    balancer.add_sample(std::array{work_of(100), work_of(90'000)}, work);
    EXPECT_EQ(balancer.speeds()[0], balancer.speeds()[1]) << "devices may compile in the first frame";
    const std::array other{work_of(300), work_of(100)};
    for (int i = 0; i < 2; ++i)
        for (const auto& frame : {odd, other}) {
            EXPECT_FALSE(balancer.should_repartition());
            balancer.add_sample(frame, work);
        }
    EXPECT_FALSE(balancer.should_repartition()) << "the slower device changes from frame to frame";
    balancer.repartitioned();
    balancer.add_sample(even, work);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(balancer.should_repartition()) << "too few frames";
        balancer.add_sample(odd, work);
    }
    EXPECT_TRUE(balancer.should_repartition());
    EXPECT_NEAR(balancer.speeds()[0] / balancer.speeds()[1], 3, 1e-9);
    balancer.repartitioned();
    EXPECT_FALSE(balancer.should_repartition());
    // The repartition had no effect: the next ones are requested later and later.
    for (const std::size_t later : {4u, 8u, 16u}) {
        balancer.add_sample(even, work); // the first frame after a repartition is ignored
        std::size_t frames = 0;
        while (!balancer.should_repartition() && frames < 100) {
            balancer.add_sample(odd, work);
            ++frames;
        }
        EXPECT_EQ(frames, later) << "after a repartition without effect";
        balancer.repartitioned();
    }
}

/// Work is counted exactly, so one frame is enough; speeds need more frames.
TEST(LoadBalancer, RepartitionsAtOnceWhenWorkIsUneven) {
    LoadBalancer balancer(2);
    const std::array work{100.0, 120.0}, corrected{110.0, 110.0};
    balancer.add_sample(std::array{work_of(100), work_of(100)}, work);
    EXPECT_TRUE(balancer.should_repartition());
    EXPECT_EQ(balancer.speeds()[0], balancer.speeds()[1]);
    balancer.repartitioned();
    for (int i = 0; i < 100; ++i) balancer.add_sample(std::array{work_of(110), work_of(110)}, corrected);
    EXPECT_FALSE(balancer.should_repartition());
}

/// The partition that follows from the speeds stays, although later samples are even. A device without work
/// keeps its estimated speed.
TEST(LoadBalancer, KeepsItsEstimates) {
    LoadBalancer balancer(3);
    const auto add_samples = [&](std::size_t frames, std::array<double, 3> work,
                                 const std::array<DeviceWork, 3>& done) {
        for (std::size_t i = 0; i < frames; ++i) balancer.add_sample(done, work);
    };
    add_samples(5, {100, 100, 100}, {work_of(100), work_of(125), work_of(100)});
    ASSERT_TRUE(balancer.should_repartition());
    balancer.repartitioned();
    const std::vector speeds(balancer.speeds().begin(), balancer.speeds().end());
    add_samples(100, {107, 86, 107}, {work_of(107), work_of(108), work_of(107)});
    EXPECT_FALSE(balancer.should_repartition());
    EXPECT_NEAR(balancer.speeds()[1] / balancer.speeds()[0], 0.8, 0.02);
    add_samples(1000, {107, 0, 107}, {work_of(107), work_of(0), work_of(107)});
    EXPECT_NEAR(balancer.speeds()[1] / balancer.speeds()[0], 0.8, 0.02);
}

/// Frame times that scatter by a tenth, and sometimes by a factor of two: almost no repartition of even
/// subdomains, and one if a device is slower.
TEST(LoadBalancer, IgnoresNoise) {
    std::mt19937 random(5);
    std::normal_distribution scatter(1.0, 0.1);
    const auto repartitions_in = [&](std::size_t frames, std::size_t devices, double first_time) {
        const std::vector<double> work(devices, 1.0);
        LoadBalancer balancer(devices);
        std::size_t repartitions = 0;
        for (std::size_t frame = 0; frame < frames; ++frame) {
            std::vector<DeviceWork> done;
            for (std::size_t i = 0; i < devices; ++i) {
                const double outlier = random() % 50 == 0 ? 2 : 1;
                done.push_back(
                    work_of(std::llround((i == 0 ? first_time : 1) * 1e6 * scatter(random) * outlier)));
            }
            balancer.add_sample(done, work);
            repartitions += balancer.should_repartition() ? 1 : 0;
            if (balancer.should_repartition()) balancer.repartitioned();
        }
        return repartitions;
    };
    EXPECT_LE(repartitions_in(5000, 16, 1), 5u);
    EXPECT_LE(repartitions_in(5000, 2, 1), 5u);
    EXPECT_GE(repartitions_in(100, 16, 1.2), 1u);
    EXPECT_GE(repartitions_in(100, 2, 1.2), 1u);
}

} // namespace
} // namespace tandem
