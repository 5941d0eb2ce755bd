// SPDX-License-Identifier: MIT
// Setting decision against the exact oracle, on pairs that touch, nearly touch and are clearly separate.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "algorithms/narrow_phase/contact_settings.h"
#include "algorithms/narrow_phase/reference_pair.h"
#include "algorithms/parameters/table.h"
#include "algorithms/traversal.h"
#include "tests/support/oracle_pairs.h"

namespace tandem::unit_test {
namespace {

using namespace support;

/// Results of one decision over a set of pairs.
struct Score {
    std::uint64_t pairs = 0;
    std::uint64_t missed = 0;      ///< rejected although they intersect
    std::uint64_t kept = 0;        ///< disjoint, but not rejected
    std::uint64_t unexplained = 0; ///< of the kept ones, those neither undecided in double nor degenerate
    std::uint64_t undecided_by_filter = 0, undecided_by_double = 0;
};

Score score(const std::vector<OraclePair>& pairs, DecisionPrecision decision) {
    Score result;
    for (const auto& pair : pairs) {
        EXPECT_TRUE(all_floats(pair));
        ContactCounts counts;
        reference_contacts<float>({narrowed(pair.a)}, {narrowed(pair.b)}, counts,
                                  {ContactRule::opposing, decision});
        const bool disjoint = relation(pair.a, pair.b) == Relation::disjoint;
        ++result.pairs;
        result.missed += !disjoint ? counts.rejected : 0;
        const std::uint64_t kept = disjoint && counts.rejected == 0 ? 1 : 0;
        result.kept += kept;
        result.unexplained += counts.undecided_by_double == 0 ? kept : 0;
        result.undecided_by_filter += counts.undecided_by_filter;
        result.undecided_by_double += counts.undecided_by_double;
    }
    return result;
}

std::vector<OraclePair> random_family(Family family, std::size_t count) {
    Random random(91 + static_cast<unsigned>(family));
    std::vector<OraclePair> pairs;
    for (std::size_t i = 0; i < count; ++i) pairs.push_back(random_pair(family, random));
    return pairs;
}

std::vector<OraclePair> touching(int largest, std::size_t count) {
    TouchMaker maker(17);
    std::vector<OraclePair> pairs;
    for (std::size_t i = 0; i < count; ++i)
        pairs.push_back(maker.touching(1 + i % 3, 1 + i / 3 % 3, largest));
    return pairs;
}

std::vector<OraclePair> one_ulp(int direction, std::size_t count) {
    TouchMaker maker(18);
    std::vector<OraclePair> pairs;
    for (std::size_t i = 0; i < count; ++i) pairs.push_back(maker.one_ulp(direction));
    return pairs;
}

std::map<std::string, std::vector<OraclePair>> families() {
    std::map<std::string, std::vector<OraclePair>> result;
    for (unsigned family = 0; family < static_cast<unsigned>(Family::count); ++family)
        result[name(Family(family))] = random_family(Family(family), 1000);
    result["touching"] = touching(3, 500);
    result["touching, 24 bits"] = touching(1 << 17, 500);
    result["gap of one ulp"] = one_ulp(1, 300);
    result["one ulp deep"] = one_ulp(-1, 300);
    return result;
}

TEST(ContactsDecision, NoDecisionRejectsIntersectingPairs) {
    for (const auto& [name, pairs] : families())
        for (const auto decision :
             {DecisionPrecision::fp32, DecisionPrecision::recheck, DecisionPrecision::fp64,
              DecisionPrecision::exact, DecisionPrecision::none})
            EXPECT_EQ(score(pairs, decision).missed, 0u) << name << " " << static_cast<int>(decision);
}

TEST(ContactsDecision, EachStageIsWrongOnlyForUndecidedPairs) {
    std::uint64_t wrong_in_float = 0, wrong_after_recheck = 0, undecided_by_double = 0,
                  undecided_by_filter = 0;
    for (const auto& [name, pairs] : families()) {
        SCOPED_TRACE(name);
        const auto fp32 = score(pairs, DecisionPrecision::fp32);
        const auto recheck = score(pairs, DecisionPrecision::recheck);
        const auto fp64 = score(pairs, DecisionPrecision::fp64);
        const auto exact = score(pairs, DecisionPrecision::exact);
        if (std::getenv("TANDEM_PRINT"))
            std::printf(
                "| %s | %llu | %llu | %llu | %llu | %llu | %llu | %llu |\n", name.c_str(),
                static_cast<unsigned long long>(pairs.size()), static_cast<unsigned long long>(fp32.kept),
                static_cast<unsigned long long>(recheck.kept), static_cast<unsigned long long>(fp64.kept),
                static_cast<unsigned long long>(exact.kept),
                static_cast<unsigned long long>(recheck.undecided_by_filter),
                static_cast<unsigned long long>(recheck.undecided_by_double));
        EXPECT_EQ(recheck.unexplained, 0u);
        EXPECT_EQ(fp64.unexplained, 0u);
        EXPECT_EQ(exact.kept, 0u);
        EXPECT_LE(recheck.undecided_by_double, recheck.undecided_by_filter);
        EXPECT_LE(recheck.kept, fp32.kept);
        EXPECT_EQ(fp64.undecided_by_filter, 0u);
        wrong_in_float += fp32.kept;
        wrong_after_recheck += recheck.kept;
        undecided_by_double += recheck.undecided_by_double;
        undecided_by_filter += recheck.undecided_by_filter;
    }
    EXPECT_GT(wrong_in_float, 500u);
    EXPECT_LT(wrong_after_recheck, wrong_in_float / 10);
    EXPECT_GT(undecided_by_double, 500u);
    EXPECT_LT(undecided_by_double, undecided_by_filter);
}

TEST(ContactsDecision, VerdictsAreNeverWrongInEitherPrecision) {
    std::uint64_t certain[2][3]{};
    for (const auto& [name, pairs] : families())
        for (const auto& pair : pairs) {
            const auto truth = relation(pair.a, pair.b);
            const unsigned verdicts[] = {narrow_phase::certain_verdict(narrowed(pair.a), narrowed(pair.b)),
                                         narrow_phase::certain_verdict(pair.a, pair.b)};
            for (unsigned i = 0; i < 2; ++i) {
                ++certain[i][verdicts[i]];
                EXPECT_TRUE(verdicts[i] != 1 || truth == Relation::disjoint) << name;
                EXPECT_TRUE(verdicts[i] != 2 || truth == Relation::overlapping) << name;
            }
        }
    for (const auto& counts : certain)
        for (const auto count : counts) EXPECT_GT(count, 1000u);
    EXPECT_LT(certain[1][0], certain[0][0]);
}

TEST(ContactsDecision, VerdictsDoNotDependOnTheOrderOfCornersAndTetrahedra) {
    unsigned seen[3]{};
    for (const auto& [name, pairs] : families())
        for (std::size_t i = 0; i < pairs.size(); i += 10) {
            auto [a, b] = pairs[i];
            const auto in_float = narrow_phase::certain_verdict(narrowed(a), narrowed(b));
            const auto in_double = narrow_phase::certain_verdict(a, b);
            ++seen[in_float];
            std::sort(a.begin(), a.end());
            do {
                std::rotate(b.begin(), b.begin() + 1, b.end());
                ASSERT_EQ(narrow_phase::certain_verdict(narrowed(a), narrowed(b)), in_float) << name;
                ASSERT_EQ(narrow_phase::certain_verdict(narrowed(b), narrowed(a)), in_float) << name;
                ASSERT_EQ(narrow_phase::certain_verdict(b, a), in_double) << name;
            } while (std::next_permutation(a.begin(), a.end()));
        }
    for (const auto count : seen) EXPECT_GT(count, 100u);
}

TEST(ContactsDecision, CertificatesAreNeverWrongInAnyOrder) {
    std::uint64_t certain[2][3]{};
    for (const auto& [name, pairs] : families())
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            auto [a, b] = pairs[i];
            const auto truth = relation(a, b);
            const auto check = [&] {
                const unsigned verdicts[] = {narrow_phase::certificate(narrowed(a), narrowed(b)),
                                             narrow_phase::certificate(a, b)};
                for (unsigned wide = 0; wide < 2; ++wide) {
                    ++certain[wide][verdicts[wide]];
                    ASSERT_TRUE(verdicts[wide] != 1 || truth == Relation::disjoint) << name;
                    ASSERT_TRUE(verdicts[wide] != 2 || truth == Relation::overlapping) << name;
                }
            };
            check();
            std::swap(a, b);
            check();
            if (i % 10 != 0) continue;
            std::sort(a.begin(), a.end());
            do {
                std::rotate(b.begin(), b.begin() + 1, b.end());
                check();
            } while (std::next_permutation(a.begin(), a.end()));
        }
    for (const auto& counts : certain)
        for (const auto count : counts) EXPECT_GT(count, 1000u);
}

TEST(ContactsDecision, FlatAndUnusableTetrahedraAreDecidedExactly) {
    const Corners<float> block{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}}};
    const Corners<float> flat_inside{{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}, {2, 2, 0}}};
    const Corners<float> flat_beside{{{1, 1, -1}, {2, 1, -1}, {1, 2, -1}, {2, 2, -1}}};
    auto spoiled = flat_beside;
    spoiled[1][1] = std::numeric_limits<float>::quiet_NaN();
    ContactCounts counts;
    const auto decide = [&](const Corners<float>& b) {
        counts = {};
        EXPECT_TRUE(
            reference_contacts<float>({block}, {b}, counts, {ContactRule::sat, DecisionPrecision::exact})
                .empty());
        return std::pair(counts.rejected, counts.degenerate);
    };
    using Counted = std::pair<std::uint64_t, std::uint64_t>;
    EXPECT_EQ(decide(flat_inside), Counted(0, 1));
    EXPECT_EQ(decide(flat_beside), Counted(1, 0));
    EXPECT_EQ(decide(spoiled), Counted(0, 1));
}

/// Sums of three coordinates are rounded twice, so their bounds miss pairs without safe rounding.
TEST(ExactContacts, AreEqualForEveryKWhoseBoundsMissNothing) {
    const auto& tiled = algorithm("tiled");
    for (const auto& k : parameters::k.choices()) {
        const auto equal = [&](const std::string& rounding) {
            const SettingTexts given{{"k", std::string(k.text)},
                                     {"rounding", rounding},
                                     {"output", "contacts"},
                                     {"decision", "exact"}};
            return contacts_are_equal_for_every_k(resolve(tiled.parameters(), {}, given, tiled.name()));
        };
        EXPECT_TRUE(equal("safe")) << k.text;
        EXPECT_TRUE(equal("directed")) << k.text;
        EXPECT_FALSE(equal("published")) << k.text;
        EXPECT_EQ(equal("nearest"), k.value == 6 || k.value == 12 || k.value == 16 || k.value == 18)
            << k.text;
    }
}

} // namespace
} // namespace tandem::unit_test
