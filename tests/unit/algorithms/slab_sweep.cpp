// SPDX-License-Identifier: MIT
// Overlapping boxes against all pairs one by one: few and many, scattered over cells or along a line, some
// larger than all others together.
#include "algorithms/broad_phase/slab_sweep.h"
#include "tests/support/test.h"

#include <random>

namespace tandem {
namespace {

constexpr std::size_t axis_count = 4;

/// `size`: of the domain; `large`: one of that many boxes spans all of it.
std::vector<double> boxes_in(std::size_t count, std::array<double, axis_count> size, std::size_t large) {
    std::mt19937 random(7);
    std::vector<double> slabs;
    for (std::size_t i = 0; i < count; ++i)
        for (const double length : size) {
            const double middle = std::uniform_real_distribution(0.0, length)(random);
            const double half = i % large == 0 ? length : std::uniform_real_distribution(0.2, 1.0)(random);
            slabs.insert(slabs.end(), {middle - half, middle + half});
        }
    return slabs;
}

std::vector<BodyPair> one_by_one(const std::vector<double>& slabs) {
    const auto count = static_cast<std::uint32_t>(slabs.size() / (2 * axis_count));
    std::vector<BodyPair> pairs;
    for (std::uint32_t a = 0; a < count; ++a)
        for (std::uint32_t b = a + 1; b < count; ++b) {
            bool overlap = true;
            for (std::size_t axis = 0; overlap && axis < axis_count; ++axis) {
                const auto* of_a = &slabs[2 * (a * axis_count + axis)];
                const auto* of_b = &slabs[2 * (b * axis_count + axis)];
                overlap = of_a[0] <= of_b[1] && of_b[0] <= of_a[1];
            }
            if (overlap) pairs.push_back({a, b});
        }
    return pairs;
}

void expect_right(const std::vector<double>& slabs) {
    const auto right = one_by_one(slabs);
    ASSERT_GT(right.size(), 10u);
    for (std::size_t sweep = 0; sweep < axis_count; ++sweep)
        EXPECT_EQ(overlapping(slabs, axis_count, sweep), right);
}

TEST(SlabSweep, Few) { expect_right(boxes_in(500, {20, 20, 20, 20}, 1000)); }
TEST(SlabSweep, ManyInCells) { expect_right(boxes_in(5000, {60, 60, 60, 60}, 10000)); }
TEST(SlabSweep, ManyInOneLayer) { expect_right(boxes_in(4000, {80, 0.5, 80, 60}, 10000)); }
TEST(SlabSweep, ManyAlongALine) { expect_right(boxes_in(4000, {0.5, 500, 0.5, 60}, 10000)); }
TEST(SlabSweep, SomeSpanTheDomain) { expect_right(boxes_in(4000, {60, 60, 60, 60}, 40)); }

/// On an integer lattice: bounds of boxes and of cells touch.
TEST(SlabSweep, TouchingOverlaps) {
    std::vector<double> slabs;
    for (int i = 0; i < 4096; ++i)
        for (const int at : {i % 16, i / 16 % 16, i / 256, i % 3}) {
            const double lower = at;
            slabs.insert(slabs.end(), {lower, lower + 1});
        }
    expect_right(slabs);
}

/// Bodies without vertices have slabs from plus to minus infinity, which overlap nothing.
TEST(SlabSweep, EmptySlabs) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    auto slabs = boxes_in(4000, {60, 60, 60, 60}, 10000);
    for (std::size_t i = 0; i < slabs.size(); i += 2 * axis_count * 7)
        for (std::size_t end = 0; end < 2 * axis_count; ++end)
            slabs[i + end] = end % 2 == 0 ? infinity : -infinity;
    expect_right(slabs);
    EXPECT_TRUE(overlapping({}, axis_count, 0).empty());
}

} // namespace
} // namespace tandem
