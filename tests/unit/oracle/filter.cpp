// SPDX-License-Identifier: MIT
// Every tier gives the answer of the slowest one, and every certificate of the filter is correct.
#include "geometry/filter.h"
#include "geometry/lattice.h"
#include "base/parallel.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/sanitized.h"
#include "tests/support/test.h"

#include <atomic>
#include <mutex>

namespace tandem {
namespace {

using namespace support;

const unsigned parts = sanitized() ? 1 : 15;
constexpr unsigned families = static_cast<unsigned>(Family::count);

class OracleFilter : public testing::TestWithParam<unsigned> {
protected:
    Family family() const { return static_cast<Family>(GetParam()); }
};

/// 8 x 15000 pairs; with sanitizers 8 x 1000.
TEST_P(OracleFilter, AgreesWithBigIntegers) {
    constexpr unsigned pairs = 1000;
    std::atomic<unsigned> wrong = 0;
    std::mutex mutex;
    DecisionCounts counts;
    parallel_for(parts, [&](std::size_t part) {
        Random random(100 * GetParam() + part);
        DecisionCounts found;
        for (unsigned i = 0; i < pairs; ++i) {
            const auto [a, b] = random_pair(family(), random);
            const auto truth = decide(a, b, Tier::big_integers);
            const auto fast = decide(a, b, Tier::filter);
            wrong += truth.relation != fast.relation;
            wrong += truth.relation != decide(a, b, Tier::integers).relation;
            wrong += truth.relation != decide(a, b).relation;
            wrong += truth.tier < Tier::big_integers;
            found.add(fast);
        }
        const std::scoped_lock lock(mutex);
        counts.add(found);
    });
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(counts[Relation::invalid], 0u);
    EXPECT_GT(counts[Relation::disjoint], parts * pairs / 100);
    EXPECT_GT(counts[Relation::overlapping], parts * pairs / 100);
    const bool easy =
        family() == Family::generic || family() == Family::far_origin || family() == Family::tiny;
    const unsigned least = easy ? parts * pairs * 999 / 1000 : 1;
    EXPECT_GE(counts[Tier::filter], least) << "the filter decides almost all of the easy ones";
}

/// A facet that the filter certifies has a negative gap.
TEST_P(OracleFilter, CertifiesNegativeGapsOnly) {
    Random random(GetParam());
    unsigned certified = 0;
    for (unsigned i = 0; i < 1000; ++i) {
        const auto [a, b] = random_pair(family(), random);
        const auto filtered = geometry::filter(a, b);
        const auto lattice = geometry::big_lattice(a, b);
        const bool solid_a = geometry::orientation(lattice.a) != 0,
                   solid_b = geometry::orientation(lattice.b) != 0;
        ASSERT_LE(filtered.volume[0], solid_a);
        ASSERT_LE(filtered.volume[1], solid_b);
        if (filtered.disjoint || !solid_a || !solid_b) continue;
        geometry::for_each_facet(lattice.a, lattice.b, geometry::all_facets & ~filtered.unsure,
                                 [&](const auto& facet) {
                                     ++certified;
                                     EXPECT_LT(facet.gap, 0);
                                     return true;
                                 });
    }
    EXPECT_GT(certified, 0u);
}

INSTANTIATE_TEST_SUITE_P(Families, OracleFilter, testing::Range(0u, families), [](const auto& instance) {
    std::string text = name(static_cast<Family>(instance.param));
    std::replace(text.begin(), text.end(), ' ', '_');
    return text;
});

/// A needle so thin that the products in its base's normal have few significant bits or none, and a
/// tetrahedron of size 1 at the tip of the base. Normals have arbitrary directions, and differences are
/// large.
TEST(OracleFilter, UnderflowIsCovered) {
    Random random(1);
    for (int exponent = -541; exponent <= -531; ++exponent)
        for (int i = 0; i < 600; ++i) {
            auto [a, b] = random_pair(Family::generic, random);
            for (unsigned corner = 0; corner < 3; ++corner)
                for (auto& x : a[corner]) x = corner == 0 ? 0 : std::ldexp(x, exponent);
            b[0] = a[0];
            ASSERT_EQ(decide(a, b).relation, decide(a, b, Tier::big_integers).relation) << exponent;
        }
}

} // namespace
} // namespace tandem
