// SPDX-License-Identifier: MIT
// Lists of pairs, bounded and tested by the kernels of the traversals, against the exact truth.
#include "harness/verify/adversarial.h"
#include "base/error.h"
#include "tests/hard/support.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

#ifdef TANDEM_SANITIZED // sanitized host kernels exist for two geometries only
constexpr std::array tested{8, 18};
#else
constexpr std::array tested{8, 18, 26};
#endif

class Adversarial : public OnDevice {
protected:
    std::vector<AdversarialCell> cells(Rounding rounding) {
        std::vector<AdversarialCell> result;
        for (const int k : {8, 18, 26}) result.push_back({&on, {.k = k, .rounding = rounding}});
        return result;
    }
};

TEST_P(Adversarial, SafeRoundingMissesNothing) {
    std::uint64_t met = 0;
    for (const auto& family : hard_families()) {
        if (!is_adversarial(family)) continue;
        const auto tally = run_adversarial(family, cells(Rounding::safe),
                                           {.pairs = 600, .batch = 70, .sample = 1, .clipped = 20});
        EXPECT_TRUE(tally.ok()) << family.name;
        EXPECT_EQ(tally.pairs, 600u) << family.name; // two batches of 60 at each difficulty
        EXPECT_EQ(tally.decided, tally.pairs);
        EXPECT_EQ(tally.clipped, family.truth == HardTruth::geometry ? 100u : 0u) << family.name;
        met += tally.touching + tally.overlapping;
    }
    EXPECT_GT(met, 10000u);
}

/// The same pairs with slabs rounded to nearest: misses are detected, for sets with diagonals only.
TEST_P(Adversarial, RoundingToNearestMissesPairs) {
    const auto tally =
        run_adversarial(hard_family("corner-cancellation"), cells(Rounding::nearest), {.pairs = 5000});
    EXPECT_EQ(tally.contradictions, 0u);
    EXPECT_GT(tally.missed[0], 0u);
    EXPECT_EQ(tally.missed[1], 0u);
    if (tested.size() > 2) {
        EXPECT_GT(tally.missed[2], 0u);
    }
    ASSERT_TRUE(tally.first);
    EXPECT_EQ(tally.first->cell, 0u);
    const auto pair = hard_pair(hard_family("corner-cancellation"), tally.first->seed, tally.first->index,
                                tally.first->difficulty);
    EXPECT_EQ(hard_test::relation_of(pair), Relation::touching);
    EXPECT_FALSE(hard_test::slabs_overlap(pair, directions({.k = 8}), false, 0));
    EXPECT_FALSE(tally.ok());
}

TANDEM_ON_DEVICES(Adversarial);

TEST(AdversarialFamilies, TalliesAreMerged) {
    AdversarialTally one, other, sum;
    one.pairs = 1, one.touching = 2, one.overlapping = 3, one.decided = 4, one.clipped = 5;
    other.pairs = 10, other.touching = 20, other.overlapping = 30, other.decided = 40, other.clipped = 50;
    one.missed = {0, 0}, one.false_pairs = {6, 7};
    other.missed = {0, 1}, other.false_pairs = {60, 70};
    other.first = {1, 0.5, 2, 3};
    sum.add(one);
    EXPECT_TRUE(sum.ok());
    sum.add(other);
    EXPECT_FALSE(sum.ok());
    EXPECT_EQ((std::array{sum.pairs, sum.touching, sum.overlapping, sum.decided, sum.clipped}),
              (std::array<std::uint64_t, 5>{11, 22, 33, 44, 55}));
    EXPECT_EQ(sum.missed, other.missed);
    EXPECT_EQ(sum.false_pairs, (std::vector<std::uint64_t>{66, 77}));
    ASSERT_TRUE(sum.first);
    EXPECT_EQ(sum.first->index, 3u);
    AdversarialTally contradicted;
    contradicted.contradictions = 1;
    contradicted.missed = contradicted.false_pairs = {0, 0};
    one.add(contradicted);
    EXPECT_FALSE(one.ok());
}

TEST(AdversarialFamilies, RefuseFamiliesWithoutPairs) {
    EXPECT_THROW(run_adversarial(hard_family("all-overlap"), {}, {}), InputError);
    EXPECT_THROW(run_adversarial(hard_family("not-finite"), {}, {}), InputError);
}

} // namespace
} // namespace tandem
