// SPDX-License-Identifier: MIT
// The oracle against CGAL's exact predicates. Sets are closed; both tetrahedra have volume because CGAL
// requires it.
#include "geometry/facets.h"
#include "geometry/lattice.h"
#include "tests/support/oracle_pairs.h"
#include "tests/support/test.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Tetrahedron_3.h>
#include <CGAL/intersections.h>

namespace tandem {
namespace {

using namespace support;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Tetrahedron_3 tetrahedron(const TetraCorners& t) {
    const auto point = [&](unsigned i) { return Kernel::Point_3(t[i][0], t[i][1], t[i][2]); };
    return {point(0), point(1), point(2), point(3)};
}

bool solid(const OraclePair& pair) {
    const auto lattice = geometry::big_lattice(pair.a, pair.b);
    return geometry::orientation(lattice.a) != 0 && geometry::orientation(lattice.b) != 0;
}

/// Whether the fast tiers and the slow tier agree with CGAL on closed intersection.
bool agree(const OraclePair& pair) {
    const bool intersect = CGAL::do_intersect(tetrahedron(pair.a), tetrahedron(pair.b));
    return intersect == (relation(pair.a, pair.b) != Relation::disjoint)
           && intersect == (decide(pair.a, pair.b, Tier::integers).relation != Relation::disjoint);
}

TEST(OracleCgal, RandomFamilies) {
    for (unsigned family = 0; family < static_cast<unsigned>(Family::count); ++family) {
        Random random(family);
        unsigned compared = 0;
        for (int i = 0; i < 10000; ++i) {
            const auto pair = random_pair(static_cast<Family>(family), random);
            if (!solid(pair)) continue;
            ++compared;
            ASSERT_TRUE(agree(pair)) << name(static_cast<Family>(family)) << ' ' << i;
        }
        EXPECT_GT(compared, 9000u) << name(static_cast<Family>(family));
    }
}

TEST(OracleCgal, ConstructedFamilies) {
    TouchMaker make(1);
    for (int i = 0; i < 500; ++i) {
        for (unsigned of_a = 1; of_a <= 3; ++of_a)
            for (unsigned of_b = 1; of_b <= 3; ++of_b)
                for (const int largest : {1, 40, 1 << 17})
                    ASSERT_TRUE(agree(make.touching(of_a, of_b, largest))) << of_a << ' ' << of_b << ' ' << i;
        ASSERT_TRUE(agree(make.one_ulp(1))) << i;
        ASSERT_TRUE(agree(make.one_ulp(-1))) << i;
        ASSERT_TRUE(agree(make.nested())) << i;
    }
}

} // namespace
} // namespace tandem
