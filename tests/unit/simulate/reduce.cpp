// SPDX-License-Identifier: MIT
#include "base/random.h"
#include "scenes/simulate/reduce.h"
#include "tests/support/test.h"

#include <chrono>

namespace tandem {
namespace {

const std::vector<double> sizes{1, 1, 100};

ContactPoint contact(Pair pair, std::uint32_t feature, std::array<double, 3> point, double depth = 0,
                     std::array<double, 3> normal = {0, 1, 0}) {
    return {pair, feature, point, normal, depth};
}

double distance(const ContactPoint& a, const ContactPoint& b) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += (a.point[i] - b.point[i]) * (a.point[i] - b.point[i]);
    return std::sqrt(sum);
}

/// Points on a unit square, two of three within 8e-7 of another.
std::vector<ContactPoint> square(std::size_t count, std::uint32_t body_b) {
    Random random(11);
    std::vector<ContactPoint> contacts;
    for (std::uint32_t i = 0; i < count; ++i) {
        auto c =
            contact({0, i, body_b, i / 3}, 0, {random.uniform(), 0, random.uniform()}, -random.uniform());
        if (i % 3 != 0) {
            c.point = contacts.back().point;
            c.point[0] += 4e-7 * random.uniform();
        }
        contacts.push_back(c);
    }
    return contacts;
}

TEST(SimulateReduce, NearbyContactsOfTheSameBodiesAreMerged) {
    const std::vector<ContactPoint> contacts{
        contact({0, 0, 1, 0}, 3, {0, 0, 0}, -1), contact({0, 1, 1, 0}, 0, {5e-7, 0, 0}, -2),
        contact({0, 2, 1, 0}, 0, {5e-7, 0, 0}, -3, {1, 0, 0}), contact({0, 3, 1, 0}, 0, {2e-6, 0, 0}, -4),
        contact({0, 4, 2, 0}, 0, {0, 0, 0}, -5)};
    const auto kept = reduce_contacts(contacts, sizes, {});
    ASSERT_EQ(kept.size(), 4u);
    EXPECT_EQ(kept[0].feature, 3u);     // the first represents both,
    EXPECT_EQ(kept[0].depth, -2);       // with the larger depth
    EXPECT_EQ(kept[1].normal[0], 1);    // a different direction
    EXPECT_EQ(kept[2].point[0], 2e-6);  // too far away
    EXPECT_EQ(kept[3].pair.body_b, 2u); // a different body
}

TEST(SimulateReduce, NeighboursAreFoundAcrossCells) {
    const auto contacts = square(3000, 1);
    const auto kept = reduce_contacts(contacts, sizes, {});
    EXPECT_EQ(kept.size(), 1000u);
    // Against all pairs: no two kept contacts are near each other, and every omitted one is near a kept one.
    for (std::size_t i = 0; i < kept.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) ASSERT_GE(distance(kept[i], kept[j]), 1e-6);
}

TEST(SimulateReduce, IsRelativeToSize) {
    auto contacts = square(300, 1);
    const auto kept = reduce_contacts(contacts, sizes, {});
    for (auto& c : contacts)
        for (auto& x : c.point) x *= 0x1p-30;
    const auto small = reduce_contacts(contacts, std::vector{0x1p-30, 0x1p-30}, {});
    ASSERT_EQ(small.size(), kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_EQ(small[i].pair, kept[i].pair);
}

TEST(SimulateReduce, PerPairKeepsTheDeepestAndTheCorners) {
    std::vector<ContactPoint> contacts;
    std::uint32_t next = 0;
    for (int x = 0; x <= 10; ++x)
        for (int z = 0; z <= 10; ++z)
            contacts.push_back(
                contact({0, next++, 1, 0}, 0, {x * 0.1, 0, z * 0.1}, x == 4 && z == 5 ? -2 : -1));
    const auto kept = reduce_contacts(contacts, sizes, {.per_pair = 5});
    ASSERT_EQ(kept.size(), 5u);
    const std::vector<std::uint32_t> expected{0, 10, 49, 110, 120};
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(kept[i].pair.tet_a, expected[i]);
}

TEST(SimulateReduce, PerPairKeepsEveryDirection) {
    std::vector<ContactPoint> contacts;
    for (std::uint32_t i = 0; i < 50; ++i) contacts.push_back(contact({0, i, 1, 0}, 0, {0.02 * i, 0, 0}));
    contacts.push_back(contact({0, 50, 1, 0}, 0, {0.5, 0, 0}, 0, {1, 0, 0}));
    const auto kept = reduce_contacts(contacts, sizes, {.per_pair = 3});
    EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [](const auto& c) { return c.normal[0] == 1; }));
}

TEST(SimulateReduce, ZeroDistanceKeepsAllAndOutputIsByBodies) {
    // In the order of (pair, feature), bodies 1 and 2 alternate.
    std::vector<ContactPoint> contacts;
    for (std::uint32_t i = 0; i < 10; ++i)
        for (const std::uint32_t body : {1u, 2u}) contacts.push_back(contact({0, i, body, 0}, 0, {0, 0, 0}));
    const auto kept = reduce_contacts(contacts, sizes, {.distance = 0});
    ASSERT_EQ(kept.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_EQ(kept[i].pair.body_b, i < 10 ? 1u : 2u);
        EXPECT_EQ(kept[i].pair.tet_a, i % 10);
    }
    EXPECT_TRUE(reduce_contacts({}, sizes, {.per_pair = 4}).empty());
}

TEST(SimulateReduce, AMillionContactsInASecond) {
    std::vector<ContactPoint> contacts;
    Random random(2);
    for (std::uint32_t body = 0; body < 1000; ++body)
        for (std::uint32_t i = 0; i < 1000; ++i)
            contacts.push_back(contact({body, i, body + 1, i}, 0, {random.uniform(), 0, random.uniform()}));
    const std::vector<double> many(1001, 1.0);
    const auto start = std::chrono::steady_clock::now();
    const auto kept = reduce_contacts(contacts, many, {.distance = 1e-6, .per_pair = 16});
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(kept.size(), 16000u);
    RecordProperty("milliseconds", static_cast<int>(seconds.count() * 1000));
    EXPECT_LT(seconds.count(), 10); // far above the expected time: only a wrong complexity fails
}

} // namespace
} // namespace tandem
