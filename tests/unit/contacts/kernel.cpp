// SPDX-License-Identifier: MIT
// The contact kernel on every available device against the serial reference: equal bits.
#include "backends/host/host_device.h"
#include "tests/support/test.h"
#include "tests/unit/contacts/kernels.h"

#include "backends/registry.h"
#include "scenes/hard/hard.h"
#include "tests/support/contact_rules.h"
#include "tests/support/long_form.h"
#include "tests/support/oracle_nested.h"
#include "tests/support/oracle_pairs.h"

namespace tandem::unit_test {
namespace {

/// Results of the reference, per pair and in total.
template<class Real>
struct Expected {
    explicit Expected(const std::vector<TetrahedronPair<Real>>& pairs, ContactSettings settings = {}) {
        for (std::uint32_t i = 0; i < pairs.size(); ++i) {
            const auto& p = pairs[i];
            contacts.push_back(reference_contacts(p.given_a(), p.given_b(), counts, settings));
            total += contacts.back().size();
            const auto id = ContactKernels<Real>::input_id(i);
            for (const auto& contact : contacts.back()) {
                const auto [a, b] = contact_terms(0, id, 1, id, contact);
                digest_a += a;
                digest_b += b;
            }
        }
    }

    std::vector<std::vector<Contact<Real>>> contacts;
    ContactCounts counts;
    std::uint64_t total = 0, digest_a = 0, digest_b = 0;
};

template<class Real>
std::vector<TetrahedronPair<Real>> random_pairs(std::size_t count) {
    PairMaker<Real> maker;
    std::vector<TetrahedronPair<Real>> pairs;
    for (std::size_t i = 0; i < count; ++i)
        pairs.push_back(
            maker.make(static_cast<typename PairMaker<Real>::Family>(i % PairMaker<Real>::family_count)));
    return pairs;
}

/// How many pairs of each kind are added: the short form tries each kind as well.
unsigned pairs_of_a_kind() { return support::long_form() ? 200 : 50; }

/// Pairs of floats that touch or nearly touch, for which the error bounds of the decision matter.
template<class Real>
void add_close_pairs(std::vector<TetrahedronPair<Real>>& pairs) {
    using namespace support;
    Random random(5);
    TouchMaker maker(6);
    for (unsigned i = 0; i < pairs_of_a_kind(); ++i)
        for (const auto& pair :
             {random_pair(Family::near_touch, random), random_pair(Family::mixed_exponents, random),
              random_pair(Family::needle, random), maker.one_ulp(1), maker.one_ulp(-1),
              maker.touching(1 + i % 3, 1 + i / 3 % 3, 1 << 17)})
            pairs.push_back({narrowed<Real>(pair.a), narrowed<Real>(pair.b)});
}

/// Exactly concentric pairs: a tetrahedron and its point reflection in its centre.
template<class Real>
void add_concentric_pairs(std::vector<TetrahedronPair<Real>>& pairs) {
    PairMaker<Real> maker;
    for (unsigned i = 0; i < pairs_of_a_kind(); ++i) {
        const auto a = changed(maker.make(PairMaker<Real>::lattice).a, [](Real x) { return 2 * x; });
        auto b = a;
        for (unsigned k = 0; k < 3; ++k)
            for (auto& corner : b) corner[k] = (a[0][k] + a[1][k] + a[2][k] + a[3][k]) / 2 - corner[k];
        pairs.push_back({a, b});
    }
}

/// Pairs of which one contains the other; shared features are shared exactly.
template<class Real>
void add_nested_pairs(std::vector<TetrahedronPair<Real>>& pairs) {
    using namespace support;
    NestedMaker maker(7);
    for (unsigned i = 0; i < pairs_of_a_kind() / 2 * static_cast<unsigned>(Nesting::count); ++i) {
        const auto pair = maker.make(static_cast<Nesting>(i % static_cast<unsigned>(Nesting::count)));
        pairs.push_back({narrowed<Real>(pair.a), narrowed<Real>(pair.b)});
    }
}

/// Pairs of every family of hard cases, and one pair in which rounding clips faces to polygons of more than
/// seven corners.
template<class Real>
void add_hard_pairs(std::vector<TetrahedronPair<Real>>& pairs) {
    const auto add = [&pairs](const FloatCorners& a, const FloatCorners& b) {
        const auto real = [](const FloatCorners& corners) {
            Corners<Real> result;
            for (unsigned i = 0; i < 4; ++i)
                std::copy(corners[i].begin(), corners[i].end(), result[i].begin());
            return result;
        };
        pairs.push_back({real(a), real(b)});
    };
    for (const auto& family : hard_families())
        for (std::uint64_t i = 0; family.pair != nullptr && i < pairs_of_a_kind(); ++i) {
            const auto pair = hard_pair(family, 1, i, family.knob.initial);
            add(pair.a, pair.b);
        }
    add({{{-0x1.167fc4p-1f, -0x1.46264cp-3f, 0x1.6e0774p-1f},
          {-0x1.fdd7p-9f, -0x1.cb92bep-1f, 0x1.e5dd48p-1f},
          {0x1.1bf32p-7f, -0x1.33522ap+0f, 0x1.1b0ee4p+0f},
          {0x1.031a8p-4f, -0x1.2d293p-1f, 0x1.9ccabap-1f}}},
        {{{-0x1.54b3a4p-2f, -0x1.bb52dp-1f, 0x1.7670fcp-1f},
          {0x1.031a8p-4f, -0x1.2d293p-1f, 0x1.9ccabap-1f},
          {-0x1.0408c8p-2f, -0x1.2b97cp-1f, 0x1.17cf34p+0f},
          {0x1.d292p-5f, -0x1.c236dp-1f, 0x1.9cc4p-2f}}});
}

template<class Real>
class ContactsKernel : public testing::Test {
protected:
    void SetUp() override {
        for (auto& backend : discover())
            for (auto& device : backend.devices)
                if (sizeof(Real) == 4 || device->info().has_double) devices.push_back(std::move(device));
        ASSERT_FALSE(devices.empty());
        // The host's kernels work on packs of elements, whose size depends on the level of instructions.
        for (const auto levels = host::compiled_levels(); const int level : levels)
            if (level != *levels.rbegin()) devices.push_back(host::make_device(level));
    }

    /// Group sizes to run with: the host runs groups of one.
    static std::vector<std::uint32_t> group_sizes(const Device& device) {
        if (device.info().max_group_size == 1) return {1};
        return {1, 64};
    }

    std::vector<std::unique_ptr<Device>> devices;
};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsKernel, Reals);

TYPED_TEST(ContactsKernel, EqualsTheReferenceBitForBit) {
    const auto pairs = random_pairs<TypeParam>(28000);
    const Expected<TypeParam> expected(pairs);
    ASSERT_GT(expected.total, pairs.size() / 4);
    ASSERT_GT(expected.counts.degenerate, 1000u);
    ASSERT_GT(expected.counts.rejected, 1000u);
    ASSERT_GT(expected.counts.without_boundary, 500u);
    const auto count = static_cast<std::uint32_t>(pairs.size());
    for (auto& device : this->devices)
        for (const auto group_size : this->group_sizes(*device)) {
            SCOPED_TRACE(device->info().id + " groups of " + std::to_string(group_size));
            ContactKernels<TypeParam> kernels(*device, pairs, group_size);
            const auto outcome = kernels.run(0, count, 0, count, static_cast<std::uint32_t>(expected.total));
            ASSERT_EQ(outcome.counter(STATUS_CONTACTS), expected.total);
            EXPECT_EQ(outcome.counter(STATUS_DEGENERATE), expected.counts.degenerate);
            EXPECT_EQ(outcome.counter(STATUS_REJECTED), expected.counts.rejected);
            EXPECT_EQ(outcome.counter(STATUS_WITHOUT_BOUNDARY), expected.counts.without_boundary);
            EXPECT_EQ(outcome.digest_a(),
                      expected.digest_a); // covers every bit of every value
            EXPECT_EQ(outcome.digest_b(), expected.digest_b);
            EXPECT_EQ(by_pair(outcome, expected.total, pairs.size()), expected.contacts);
        }
}

// The limits of certificates, and scales at which products of their distances would overflow or underflow.
TYPED_TEST(ContactsKernel, EqualsTheReferenceAtEveryScale) {
    auto pairs = random_pairs<TypeParam>(16200);
    for (std::size_t i = 0; i < pairs.size(); ++i)
        for (auto* corners : {&pairs[i].a, &pairs[i].b})
            for (auto& corner : *corners)
                for (auto& x : corner) x = std::ldexp(x, static_cast<int>(i % 81) - 40);
    const Expected<TypeParam> expected(pairs);
    ASSERT_GT(expected.counts.rejected, 1000u);
    const auto count = static_cast<std::uint32_t>(pairs.size());
    for (auto& device : this->devices) {
        SCOPED_TRACE(device->info().id);
        ContactKernels<TypeParam> kernels(*device, pairs, this->group_sizes(*device).back());
        const auto outcome = kernels.run(0, count, 0, count, static_cast<std::uint32_t>(expected.total));
        EXPECT_EQ(outcome.counter(STATUS_DEGENERATE), expected.counts.degenerate);
        EXPECT_EQ(outcome.counter(STATUS_REJECTED), expected.counts.rejected);
        EXPECT_EQ(outcome.counter(STATUS_WITHOUT_BOUNDARY), expected.counts.without_boundary);
        ASSERT_EQ(outcome.counter(STATUS_CONTACTS), expected.total);
        EXPECT_EQ(outcome.digest_a(), expected.digest_a);
        EXPECT_EQ(by_pair(outcome, expected.total, pairs.size()), expected.contacts);
    }
}

/// Every rule, and combinations with decisions; another test has the default rule.
std::vector<ContactSettings> rules_and_decisions() {
    using enum ContactRule;
    using DecisionPrecision::fp32, DecisionPrecision::fp64, DecisionPrecision::recheck;
    constexpr auto rejecting_nothing = DecisionPrecision::none;
    std::vector<ContactSettings> cases{
        {opposing, recheck}, {clip, recheck}, {restricted, recheck},          {consistent, recheck},
        {sat, fp64},         {vertex, fp64},  {published, rejecting_nothing}, {clip, rejecting_nothing}};
    for (const auto& [rule, name] : support::contact_rules())
        if (rule != opposing) cases.push_back({rule, needs_pressures(rule) ? rejecting_nothing : fp32});
    for (const auto decision : {fp32, recheck, fp64})
        cases.push_back({.rule = distance, .decision = decision, .margin = 0.5});
    return cases;
}

TYPED_TEST(ContactsKernel, EveryRuleAndDecisionEqualsTheReferenceLong) {
    TANDEM_LONG_FORM_ONLY(sizeof(TypeParam) == 8 ? "opencl" : "host");
    using enum ContactRule;
    auto pairs = random_pairs<TypeParam>(35 * pairs_of_a_kind());
    add_close_pairs(pairs);
    add_concentric_pairs(pairs);
    add_nested_pairs(pairs);
    add_hard_pairs(pairs);
    PressureMaker<TypeParam> pressures;
    for (auto& pair : pairs) pressures.set(pair);
    const auto count = static_cast<std::uint32_t>(pairs.size());
    std::set<ContactRule> compiled;
    for (const auto settings : rules_and_decisions()) {
        const bool is_next = compiled.insert(settings.rule).second;
        const Expected<TypeParam> expected(pairs, settings);
        ASSERT_GT(expected.total, pairs.size() / 20);
        if (settings.decision == DecisionPrecision::none && !needs_pressures(settings.rule))
            EXPECT_EQ(expected.counts.rejected, 0u);
        else
            ASSERT_GT(expected.counts.rejected, pairs.size() / 40);
        EXPECT_EQ(expected.counts.without_boundary > 0, boundaries_needed(settings.rule) > 0);
        for (auto& device : this->devices) {
            if (!support::long_form() && !is_next && device->info().id != "host") continue; // each rule once
            SCOPED_TRACE(device->info().id + " rule " + std::to_string(static_cast<int>(settings.rule))
                         + " decision " + std::to_string(static_cast<int>(settings.decision)));
            ContactKernels<TypeParam> kernels(*device, pairs, this->group_sizes(*device).back());
            // Two combinations decide before they try certificates; the others decide what certificates leave
            // undecided. One with decision=none has a single launch, too.
            if (settings.decision != DecisionPrecision::fp32
                && (settings.rule == clip || settings.rule == consistent || settings.margin > 0))
                kernels.set_launches(ContactStage::Launches::at_once);
            const auto outcome =
                kernels.run(0, count, 0, count, static_cast<std::uint32_t>(expected.total), settings);
            EXPECT_EQ(outcome.counter(STATUS_DEGENERATE), expected.counts.degenerate);
            EXPECT_EQ(outcome.counter(STATUS_REJECTED), expected.counts.rejected);
            EXPECT_EQ(outcome.counter(STATUS_WITHOUT_BOUNDARY), expected.counts.without_boundary);
            EXPECT_EQ(outcome.counter(STATUS_UNDECIDED_BY_FILTER), expected.counts.undecided_by_filter);
            EXPECT_EQ(outcome.counter(STATUS_UNDECIDED_BY_DOUBLE), expected.counts.undecided_by_double);
            ASSERT_EQ(outcome.counter(STATUS_CONTACTS), expected.total);
            EXPECT_EQ(by_pair(outcome, expected.total, pairs.size()), expected.contacts);
            EXPECT_EQ(outcome.digest_a(), expected.digest_a);
        }
    }
}

TYPED_TEST(ContactsKernel, PastCapacityItCountsWithoutWriting) {
    const auto pairs = random_pairs<TypeParam>(700);
    const Expected<TypeParam> expected(pairs);
    for (auto& device : this->devices)
        for (const std::uint32_t capacity : {1u, 2u, 50u}) {
            SCOPED_TRACE(device->info().id);
            ASSERT_GT(expected.total, capacity);
            ContactKernels<TypeParam> kernels(*device, pairs, this->group_sizes(*device).back());
            const auto outcome = kernels.run(0, 700, 0, 700, capacity);
            EXPECT_EQ(outcome.counter(STATUS_CONTACTS), expected.total);
            for (std::uint32_t i = 0; i < capacity + 8; ++i)
                EXPECT_EQ(outcome.rows[i].pair == ~0u, i >= capacity) << i;
            for (std::uint32_t i = 8 * capacity; i < 8 * (capacity + 8); ++i)
                EXPECT_EQ(outcome.values[i], -7);
        }
}

TYPED_TEST(ContactsKernel, ProcessesExistingPairsOnly) {
    auto pairs = random_pairs<TypeParam>(700);
    const std::vector part(pairs.begin() + 100, pairs.begin() + 400);
    const Expected<TypeParam> expected(part);
    const auto capacity = static_cast<std::uint32_t>(expected.total);
    for (auto& device : this->devices) {
        SCOPED_TRACE(device->info().id);
        ContactKernels<TypeParam> kernels(*device, pairs, this->group_sizes(*device).back());
        for (const auto launches : {ContactStage::Launches::apart, ContactStage::Launches::at_once}) {
            kernels.set_launches(launches);
            const auto outcome = kernels.run(100, 400, 0, 700, capacity);
            EXPECT_EQ(outcome.counter(STATUS_CONTACTS), expected.total);
            EXPECT_EQ(outcome.counter(STATUS_REJECTED), expected.counts.rejected);
            EXPECT_EQ(outcome.counter(STATUS_WITHOUT_BOUNDARY), expected.counts.without_boundary);
            EXPECT_EQ(outcome.counter(STATUS_DEGENERATE), expected.counts.degenerate);
            EXPECT_EQ(kernels.run(100, 700, 0, 400, capacity).counter(STATUS_CONTACTS), expected.total);
            EXPECT_EQ(kernels.run(100, 3, 1, 400, capacity).counter(STATUS_CONTACTS), expected.total);
            EXPECT_EQ(kernels.run(0, 0, 0, 700, capacity).counter(STATUS_CONTACTS), 0u);
        }
    }
}

} // namespace
} // namespace tandem::unit_test
