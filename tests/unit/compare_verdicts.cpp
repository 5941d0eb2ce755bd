// SPDX-License-Identifier: MIT
#include "harness/compare/report.h"
#include "scenes/error.h"
#include "tests/unit/compare_compared.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tandem::compare {
namespace {

using testing::HasSubstr;

Verdict verdict(double factor, const Options& options = {}) {
    return Compared({record("8", around(1, 9))}, {record("8", around(factor, 9))}, options).cell().verdict;
}

TEST(CompareVerdicts, ThresholdsAreTheSameBothWays) {
    EXPECT_EQ(verdict(1), Verdict::not_shown);
    EXPECT_EQ(verdict(1.009), Verdict::within_threshold);
    EXPECT_EQ(verdict(1 / 1.009), Verdict::within_threshold);
    EXPECT_EQ(verdict(1.011), Verdict::slower);
    EXPECT_EQ(verdict(1 / 1.011), Verdict::faster);
    Options options;
    options.threshold = 0.2;
    EXPECT_EQ(verdict(1.19, options), Verdict::within_threshold);
    EXPECT_EQ(verdict(1.21, options), Verdict::slower);
    EXPECT_EQ(verdict(1 / 1.19, options), Verdict::within_threshold);
    EXPECT_EQ(verdict(1 / 1.21, options), Verdict::faster);
    options.level = 1e-5; // 2 / 48620 is the least of 9 against 9
    EXPECT_EQ(verdict(1.21, options), Verdict::too_few);
}

TEST(CompareVerdicts, ProcessorsHaveAWiderThreshold) {
    Records before{record("8", around(1, 9))};
    Records after{record("8", around(1.02, 9))};
    EXPECT_EQ(Compared(before, after).cell().verdict, Verdict::slower);
    before[0]["devices"][0]["kind"] = after[0]["devices"][0]["kind"] = "cpu";
    const Compared compared(before, after);
    EXPECT_EQ(compared.cell().verdict, Verdict::within_threshold);
    EXPECT_EQ(compared.cell().threshold, 0.03);
    EXPECT_FALSE(compared.comparison.changed());
}

TEST(CompareVerdicts, OneSessionIsComparedInPairs) {
    // Each round is 3 % slower in the new one; rounds differ by far more.
    auto times = around(1, 10);
    for (std::size_t i = 0; i < times.size(); ++i) times[i] *= 1 + 0.3 * static_cast<double>(i);
    auto slower = times;
    for (auto& time : slower) time *= 1.03;
    const Compared paired({in_rounds("8", times, "s")}, {in_rounds("8", slower, "s")});
    EXPECT_TRUE(paired.cell().paired);
    EXPECT_EQ(paired.cell().verdict, Verdict::slower);
    EXPECT_NEAR(paired.cell().ratio.value, 1.03, 1e-12);
    EXPECT_DOUBLE_EQ(*paired.cell().p, 2.0 / 1024);
    const Compared apart({in_rounds("8", times, "s")}, {in_rounds("8", slower, "t")});
    EXPECT_FALSE(apart.cell().paired);
    EXPECT_EQ(apart.cell().verdict, Verdict::not_shown);
    EXPECT_GT(*apart.cell().least_effect, 0.1);
}

TEST(CompareVerdicts, OnlyCommonRoundsArePairs) {
    const Compared compared({record("8", {10, 20, 30, 1000}, {1, 2, 3, 9}, "s")},
                            {record("8", {5, 22, 33, 40}, {0, 2, 3, 4}, "s")});
    EXPECT_EQ(compared.cell().common, 2u);
    EXPECT_NEAR(compared.cell().ratio.value, 1.1, 1e-12);
    EXPECT_EQ(compared.cell().before_ns, 25);
    const Compared none({record("8", {10, 20}, {1, 2}, "s")}, {record("8", {5, 22}, {3, 4}, "s")});
    EXPECT_FALSE(none.cell().paired);
}

TEST(CompareVerdicts, ARoundCountsOnceHoweverManySamplesItHas) {
    std::vector<double> samples;
    std::vector<int> rounds;
    for (int round = 0; round < 3; ++round)
        for (int i = 0; i < 50; ++i) {
            samples.push_back(1e6 + i);
            rounds.push_back(round);
        }
    auto slower = samples;
    for (auto& sample : slower) sample *= 2;
    const Compared compared({record("8", samples, rounds, "s")}, {record("8", slower, rounds, "t")});
    EXPECT_EQ(compared.cell().verdict, Verdict::too_few);
    EXPECT_DOUBLE_EQ(compared.cell().least_p, 0.1);
    EXPECT_EQ(compared.cell().rounds_needed, 4u);
    EXPECT_FALSE(compared.cell().p);
    EXPECT_FALSE(compared.comparison.changed());
}

TEST(CompareVerdicts, TooFewIsSaidOfWhatTheCorrectionLeaves) {
    // 4 against 4 can give 2 / 70, which one cell may keep and two may not.
    Records before{record("8", around(1, 4))};
    Records after{record("8", around(1.5, 4))};
    EXPECT_EQ(Compared(before, after).cell().verdict, Verdict::slower);
    before.push_back(record("18", around(1, 4)));
    after.push_back(record("18", around(1.5, 4)));
    const Compared two(before, after);
    EXPECT_EQ(two.comparison.count(Verdict::too_few), 2u);
    EXPECT_EQ(two.cell().rounds_needed, 5u);
    EXPECT_FALSE(two.cell().least_effect);
    // A cell that cannot reach the level by itself takes no part in the correction.
    before[1] = record("18", around(1, 3));
    const Compared other(before, {after[0], record("18", around(1.5, 3))});
    EXPECT_EQ(other.comparison.tested, 1u);
    EXPECT_EQ(other.cell().verdict, Verdict::slower);
}

TEST(CompareVerdicts, TheLeastEffectIsThatOfTheOnlyCellToChange) {
    const Records records{record("8", around(1, 9)), record("18", around(1, 9)), record("26", around(1, 9))};
    const Compared compared(records, records);
    const double error = compared.cell().ratio.log_error;
    EXPECT_GT(error, 0);
    EXPECT_DOUBLE_EQ(*compared.cell().least_effect, least_effect(error, 0.05 / 3, 0.8));
}

TEST(CompareVerdicts, AnotherAnswerIsNotTimed) {
    for (const auto* digest : {"digest", "contact_digest"}) {
        auto after = record("8", around(2, 9));
        after["work"][digest]["b"] = "0c";
        const Compared compared({record("8", around(1, 9))}, {after});
        EXPECT_EQ(compared.cell().verdict, Verdict::another_answer);
        EXPECT_TRUE(compared.comparison.changed());
        EXPECT_EQ(compared.comparison.tested, 0u);
        EXPECT_THAT(
            text_of(compared.report()),
            HasSubstr("3 " + std::string(*digest == 'd' ? "candidate pairs" : "contacts") + " others"));
    }
    // Records from before work had them have digests of the comparison with the reference.
    auto old = record("8", around(1, 9));
    old["agreement"] = {{"digest", {{"count", 4}, {"a", "0a"}, {"b", "0b"}}}};
    old["work"] = nlohmann::json::object();
    EXPECT_EQ(Compared({old}, {record("8", around(1, 9))}).cell().verdict, Verdict::another_answer);
    old["agreement"] = nullptr;
    EXPECT_EQ(Compared({old}, {record("8", around(1, 9))}).cell().verdict, Verdict::not_shown);
}

std::string nothing_common(const Records& before, const Records& after) {
    try {
        const Compared compared(before, after);
    } catch (const InputError& error) {
        return error.what();
    }
    return "compared";
}

TEST(CompareVerdicts, WithoutACommonCellTheNearestAreNamed) {
    auto other = record("18", {1});
    EXPECT_THAT(nothing_common({record("8", {1})}, {other}),
                HasSubstr("(1 and 1 cells; the nearest differ in k=8 / k=18)"));
    other["status"] = "wrong";
    EXPECT_THAT(nothing_common({record("8", {1})}, {other}), HasSubstr("none of 1 records is ok"));
    EXPECT_THAT(nothing_common({record("8", {1})}, {record("18", {1}, {0}, "s")}),
                HasSubstr("schemas 2 and 3"));
}

} // namespace
} // namespace tandem::compare
