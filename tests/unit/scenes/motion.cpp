// SPDX-License-Identifier: MIT
#include "scenes/motion.h"
#include "base/random.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

double error_at(double angle) {
    const auto own = sine_cosine(angle);
    return std::max(std::fabs(own.sine - std::sin(angle)), std::fabs(own.cosine - std::cos(angle)));
}

TEST(ScenesRandom, PublishedSequence) {
    // The first outputs of SplitMix64 from seed 1234567, as its published C program prints them.
    Random random(1234567);
    for (const std::uint64_t expected : {6457827717110365317u, 3203168211198807973u, 9817491932198370423u,
                                         4593380528125082431u, 16408922859458223821u})
        EXPECT_EQ(random.next(), expected);
}

TEST(ScenesRandom, UniformFillsTheUnitInterval) {
    Random random(3);
    double least = 1;
    double most = 0;
    double sum = 0;
    constexpr int count = 100000;
    for (int i = 0; i < count; ++i) {
        const double x = random.uniform();
        ASSERT_EQ(x * 0x1p53, std::floor(x * 0x1p53));
        least = std::min(least, x);
        most = std::max(most, x);
        sum += x;
    }
    EXPECT_GE(least, 0);
    EXPECT_LT(least, 1e-3);
    EXPECT_LT(most, 1);
    EXPECT_GT(most, 1 - 1e-3);
    EXPECT_NEAR(sum / count, 0.5, 0.005);
}

TEST(ScenesRandom, DirectionsAndRotationsHaveUnitLengthAndNoPreference) {
    Random random(4);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Vector4d turned = Eigen::Vector4d::Zero();
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        const auto d = random.direction();
        const auto q = random.rotation();
        ASSERT_NEAR(d.norm(), 1, 1e-15);
        ASSERT_NEAR(q.norm(), 1, 1e-15);
        sum += d;
        turned += q.coeffs();
    }
    EXPECT_LT(sum.norm() / count, 0.03);
    EXPECT_LT(turned.norm() / count, 0.03);
}

TEST(ScenesMotion, SineAndCosineAgreeWithTheLibrary) {
    Random random(5);
    for (const double range : {1.0, 100.0, 1e6})
        for (int i = 0; i < 100000; ++i) {
            const double angle = random.uniform(-range, range);
            ASSERT_LT(error_at(angle), 2e-16) << angle;
        }
    // Near multiples of pi/2, one of the two results is dominated by the rounding of the argument reduction.
    for (int quarter = -6000; quarter <= 6000; ++quarter)
        ASSERT_LT(error_at(quarter * 1.5707963267948966), 2e-16) << quarter;
}

TEST(ScenesMotion, SineAndCosineOfZeroAreExact) {
    EXPECT_EQ(sine_cosine(0).sine, 0);
    EXPECT_EQ(sine_cosine(0).cosine, 1);
}

TEST(ScenesMotion, QuaternionsRotateAsMatricesDo) {
    Random random(6);
    for (int i = 0; i < 1000; ++i) {
        const auto a = random.rotation();
        const auto b = random.rotation();
        const Eigen::Vector3d v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const Eigen::Vector3d expected = a.toRotationMatrix() * (b.toRotationMatrix() * v);
        ASSERT_LT((rotated(product(a, b), v) - expected).norm(), 2e-15);
    }
}

TEST(ScenesMotion, QuarterTurnAboutZ) {
    const auto q = turn({0, 0, 1}, 1.5707963267948966);
    EXPECT_LT((rotated(q, {1, 0, 0}) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
    EXPECT_LT((rotated(q, {0, 1, 0}) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
}

TEST(ScenesMotion, UnitKeepsTheDirection) {
    const auto q = unit(Eigen::Quaterniond(3, 0, 4, 0));
    EXPECT_EQ(q.w(), 0.6);
    EXPECT_EQ(q.y(), 0.8);
    EXPECT_EQ(q.x(), 0);
}

} // namespace
} // namespace tandem
