// SPDX-License-Identifier: MIT
// How fast devices are held to be, and when bodies had better be dealt anew.
#include "algorithms/distributed/load_balancer.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace tandem {
namespace {

DeviceWork took(std::int64_t ns) { return {.bodies = 1, .body_pairs = 1, .pairs = 1, .ns = ns}; }

TEST(Balances, WantADealAfterSomeFramesOutOfBalance) {
    LoadBalancer balance(2);
    const std::array work{100.0, 100.0};
    const std::array even{took(100), took(104)}, odd{took(100), took(300)};
    EXPECT_DOUBLE_EQ(imbalance(odd), 1.5);
    balance.add_sample(std::array{took(100), took(90'000)}, work);
    EXPECT_EQ(balance.speeds()[0], balance.speeds()[1]) << "devices may compile in the first frame";
    const std::array other{took(300), took(100)};
    for (int i = 0; i < 2; ++i)
        for (const auto& frame : {odd, other}) {
            EXPECT_FALSE(balance.should_repartition());
            balance.add_sample(frame, work);
        }
    EXPECT_FALSE(balance.should_repartition()) << "now the one and now the other takes longer";
    balance.repartitioned();
    balance.add_sample(even, work);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(balance.should_repartition()) << "few frames say little";
        balance.add_sample(odd, work);
    }
    EXPECT_TRUE(balance.should_repartition());
    EXPECT_NEAR(balance.speeds()[0] / balance.speeds()[1], 3, 1e-9);
    balance.repartitioned();
    EXPECT_FALSE(balance.should_repartition());
    // The deal was of no use: the next ones are asked for later and later.
    for (const std::size_t later : {4u, 8u, 16u}) {
        balance.add_sample(even, work); // the first frame of a deal says nothing
        std::size_t frames = 0;
        while (!balance.should_repartition() && frames < 100) {
            balance.add_sample(odd, work);
            ++frames;
        }
        EXPECT_EQ(frames, later) << "after one of no use";
        balance.repartitioned();
    }
}

/// Work is counted, and known after a frame; what speeds are takes longer.
TEST(Balances, WantADealAtOnceWhereWorkIsNotEven) {
    LoadBalancer balance(2);
    const std::array work{100.0, 120.0}, mended{110.0, 110.0};
    balance.add_sample(std::array{took(100), took(100)}, work);
    EXPECT_TRUE(balance.should_repartition());
    EXPECT_EQ(balance.speeds()[0], balance.speeds()[1]);
    balance.repartitioned();
    for (int i = 0; i < 100; ++i) balance.add_sample(std::array{took(110), took(110)}, mended);
    EXPECT_FALSE(balance.should_repartition());
}

/// The deal that speeds led to stays, although what is seen after it is even; a device without work is as
/// fast as it was.
TEST(Balances, StandByWhatTheyKnow) {
    LoadBalancer balance(3);
    const auto see = [&](std::size_t frames, std::array<double, 3> work,
                         const std::array<DeviceWork, 3>& done) {
        for (std::size_t i = 0; i < frames; ++i) balance.add_sample(done, work);
    };
    see(5, {100, 100, 100}, {took(100), took(125), took(100)});
    ASSERT_TRUE(balance.should_repartition());
    balance.repartitioned();
    const std::vector speeds(balance.speeds().begin(), balance.speeds().end());
    see(100, {107, 86, 107}, {took(107), took(108), took(107)});
    EXPECT_FALSE(balance.should_repartition());
    EXPECT_NEAR(balance.speeds()[1] / balance.speeds()[0], 0.8, 0.02);
    see(1000, {107, 0, 107}, {took(107), took(0), took(107)});
    EXPECT_NEAR(balance.speeds()[1] / balance.speeds()[0], 0.8, 0.02);
}

/// Frames whose times scatter by a tenth, and now and then by twice: no deal where shares are even, and one
/// where one takes longer.
TEST(Balances, DealForWhatIsSure) {
    std::mt19937 random(5);
    std::normal_distribution scatter(1.0, 0.1);
    const auto deals_in = [&](std::size_t frames, std::size_t shares, double first_takes) {
        const std::vector<double> work(shares, 1.0);
        LoadBalancer balance(shares);
        std::size_t deals = 0;
        for (std::size_t frame = 0; frame < frames; ++frame) {
            std::vector<DeviceWork> done;
            for (std::size_t i = 0; i < shares; ++i) {
                const double hiccup = random() % 50 == 0 ? 2 : 1;
                done.push_back(
                    took(std::llround((i == 0 ? first_takes : 1) * 1e6 * scatter(random) * hiccup)));
            }
            balance.add_sample(done, work);
            deals += balance.should_repartition() ? 1 : 0;
            if (balance.should_repartition()) balance.repartitioned();
        }
        return deals;
    };
    EXPECT_LE(deals_in(5000, 16, 1), 5u);
    EXPECT_LE(deals_in(5000, 2, 1), 5u);
    EXPECT_GE(deals_in(100, 16, 1.2), 1u);
    EXPECT_GE(deals_in(100, 2, 1.2), 1u);
}

} // namespace
} // namespace tandem
