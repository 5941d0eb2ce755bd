// SPDX-License-Identifier: MIT
// Depth and normal of every rule against the exact least translation. TANDEM_PRINT=1 prints the table of the
// README in algorithms/narrow_phase.
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "harness/verify/accuracy/answer_errors.h"
#include "tests/support/contact_rules.h"
#include "tests/support/oracle_nested.h"
#include "tests/support/oracle_pairs.h"

namespace tandem::unit_test {
namespace {

using namespace support;

/// Errors of one rule over overlapping pairs.
struct Errors {
    std::size_t pairs = 0, without_contact = 0; ///< pairs without a contact
    std::vector<double> depth;                  ///< |d - d*| / (u L), L the longest edge
    std::vector<double> angle;                  ///< degrees to the nearest of the best normals

    static double at(std::vector<double> values, double fraction) {
        if (values.empty()) return 0;
        std::sort(values.begin(), values.end());
        return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1))];
    }
};

void add(Errors& errors, const OraclePair& pair, const ContactTruth& truth, ContactRule rule) {
    ContactCounts counts;
    const auto contacts = reference_contacts<float>({narrowed(pair.a)}, {narrowed(pair.b)}, counts,
                                                    {rule, DecisionPrecision::fp32});
    ++errors.pairs;
    errors.without_contact += contacts.empty() ? 1 : 0;
    if (contacts.empty()) return;
    const auto& deepest = *std::min_element(contacts.begin(), contacts.end(),
                                            [](const auto& p, const auto& q) { return p.depth < q.depth; });
    std::array<double, 3> normal;
    std::copy_n(deepest.normal.begin(), 3, normal.begin());
    const double size = std::max(longest_edge(pair.a), longest_edge(pair.b));
    errors.depth.push_back(std::abs(-static_cast<double>(deepest.depth) - truth.depth) / (0x1p-24 * size));
    errors.angle.push_back(nearest_angle(truth.normals, normal));
}

template<class Make>
Errors errors_of(ContactRule rule, Make make) {
    Errors errors;
    for (int i = 0; i < 300; ++i) {
        const auto pair = make();
        const auto truth = contact_truth(pair.a, pair.b, 1e-5);
        if (truth && truth->relation == Relation::overlapping) add(errors, pair, *truth, rule);
    }
    return errors;
}

Errors errors_of(ContactRule rule, Family family) {
    Random random(7 + static_cast<unsigned>(family));
    return errors_of(rule, [&] { return random_pair(family, random); });
}

bool printing() { return std::getenv("TANDEM_PRINT") != nullptr; }

void print(const char* family, const std::string& rule, const Errors& e) {
    if (!printing()) return;
    std::printf("| %s | %s | %zu | %zu | %.2g, %.2g | %.2g, %.2g |\n", family, rule.c_str(), e.pairs,
                e.without_contact, Errors::at(e.depth, 0.5), Errors::at(e.depth, 1), Errors::at(e.angle, 0.5),
                Errors::at(e.angle, 1));
}

TEST(ContactsAccuracy, SatFindsTheLeastTranslation) {
    for (const auto family : {Family::generic, Family::far_origin, Family::sliver, Family::scale_ratio})
        for (const auto& [rule, name_of_rule] : support::contact_rules()) {
            const bool bounded = rule == ContactRule::sat || rule == ContactRule::restricted;
            if (!bounded && !printing()) continue;
            const auto errors = errors_of(rule, family);
            print(name(family), name_of_rule, errors);
            ASSERT_GT(errors.pairs, 20u) << name(family);
            if (!bounded) continue;
            EXPECT_LT(Errors::at(errors.depth, 1), 16) << name(family);
        }
    if (!printing()) return;
    TouchMaker maker(3);
    NestedMaker nested(3);
    for (const auto& [rule, name_of_rule] : support::contact_rules()) {
        print("nested copies", name_of_rule, errors_of(rule, [&] { return maker.nested(); }));
        print("nested, touching", name_of_rule,
              errors_of(rule, [&] { return nested.make(Nesting::on_faces); }));
        print("one ulp deep", name_of_rule, errors_of(rule, [&] { return maker.one_ulp(-1); }));
    }
}

TEST(ContactsAccuracy, OfGenericPairsSatHasTheBestNormalAndClipTheNextBest) {
    const auto sat = errors_of(ContactRule::sat, Family::generic);
    const auto clip = errors_of(ContactRule::clip, Family::generic);
    const auto opposing = errors_of(ContactRule::opposing, Family::generic);
    EXPECT_LT(Errors::at(sat.angle, 1), 1e-4);
    EXPECT_LT(Errors::at(clip.angle, 0.5), Errors::at(opposing.angle, 0.5));
    EXPECT_EQ(sat.without_contact, 0u);
    EXPECT_EQ(clip.without_contact, 0u);
    EXPECT_GT(opposing.without_contact, 0u);
}

} // namespace
} // namespace tandem::unit_test
