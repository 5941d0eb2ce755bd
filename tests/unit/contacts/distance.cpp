// SPDX-License-Identifier: MIT
// Rule distance against distances in long double: no pair within the margin lacks a row, distances, points
// and normals err by a few roundings, and the order of corners and tetrahedra changes names only.
#include "tests/support/distances.h"
#include "tests/support/long_form.h"
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "base/parallel.h"
#include "base/random.h"

namespace tandem::unit_test::contacts_distance {
namespace {

using Vector = Eigen::Vector3d;
using Exact = Eigen::Vector3<long double>;
using support::FourCorners;

/// How two tetrahedra of size 1 lie. `gap`: the distance to aim at.
enum class Family {
    any,
    sliver,
    parallel_faces,
    crossing_edges,
    above_edge,
    above_corner,
    small,
    far,
    nested,
    flat
};
constexpr int families = 10;

/// Points above a plane of height `low` that a direction may tilt.
FourCorners random_solid(Random& random) {
    FourCorners solid;
    for (auto& corner : solid)
        corner = Vector(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    return solid;
}

double power_of_ten(Random& random, double low, double high) {
    return std::exp(std::log(10.0) * random.uniform(low, high));
}

/// Moves b along a direction until it is `gap` beyond a.
void part(const FourCorners& a, FourCorners& b, const Vector& direction, double gap) {
    double high = -1e300, low = 1e300;
    for (const auto& p : a) high = std::max(high, direction.dot(p));
    for (const auto& p : b) low = std::min(low, direction.dot(p));
    for (auto& p : b) p += direction * (high - low + gap);
}

/// A roof with its ridge along x at height 0, and a corner or an edge above it.
void put_above(Random& random, Family family, double gap, FourCorners& a, FourCorners& b) {
    const auto sideways = [&] { return random.uniform(-0.5, 0.5); };
    const bool is_corner = family == Family::above_corner;
    a = {Vector(-1, 0, is_corner ? -1 : 0), Vector(is_corner ? 0 : 1, 0, 0), Vector(sideways(), 0.5, -1),
         Vector(sideways(), -0.5, -1)};
    if (family == Family::crossing_edges) {
        const double turn = power_of_ten(random, -7, 0);
        b = {Vector(-1, -turn, gap), Vector(1, turn, gap), Vector(sideways(), 0.5, gap + 1),
             Vector(sideways(), -0.5, gap + 1)};
        return;
    }
    b[0] = Vector(is_corner ? 0 : random.uniform(-1, 1), random.uniform(-1e-7, 1e-7), gap);
    for (int i = 1; i < 4; ++i)
        b[static_cast<std::size_t>(i)] = b[0] + Vector(sideways(), sideways(), random.uniform(0.5, 1));
}

/// Lays a face of each in a plane; b is above a.
void face_each_other(FourCorners& a, FourCorners& b, double gap) {
    for (auto* solid : {&a, &b})
        for (auto& p : *solid) p.z() = &p == solid->data() ? std::abs(p.z()) + 0.1 : 0;
    a[0].z() *= -1;
    for (auto& p : b) p.z() += gap;
}

/// To a face, an edge or a corner.
void flatten(Random& random, FourCorners& solid) {
    solid[3] = (solid[0] + solid[1] + solid[2]) / 3;
    for (auto i = random.next() % 3; i > 0; --i) solid[i] = solid[3];
}

/// A pair, turned and moved at random.
std::pair<FourCorners, FourCorners> make(Random& random, Family family) {
    auto a = random_solid(random), b = random_solid(random);
    const double gap = power_of_ten(random, -7, 0);
    switch (family) {
    case Family::sliver:
        for (auto& p : a) p.z() *= power_of_ten(random, -6, -5);
        for (auto& p : b) p.x() *= power_of_ten(random, -6, -5);
        part(a, b, random.direction(), gap);
        break;
    case Family::parallel_faces:
        face_each_other(a, b, gap);
        break;
    case Family::crossing_edges:
    case Family::above_edge:
    case Family::above_corner:
        put_above(random, family, gap, a, b);
        break;
    case Family::small:
        for (auto& p : b) p *= 1e-4;
        part(a, b, random.direction(), gap);
        break;
    case Family::nested:
        a = {Vector(-9, -9, -9), Vector(9, -9, -9), Vector(0, 9, -9), Vector(0, 0, 9)};
        break;
    case Family::flat:
        flatten(random, b);
        part(a, b, random.direction(), gap);
        break;
    case Family::any:
    case Family::far:
        part(a, b, random.direction(), gap);
        break;
    }
    const auto turn = random.rotation();
    const double reach = family == Family::far ? 1000 : 1;
    const Vector place = reach * Vector(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    for (auto* solid : {&a, &b})
        for (auto& p : *solid) p = turn * p + place;
    return {a, b};
}

template<class Real>
Corners<Real> rounded(const FourCorners& solid) {
    Corners<Real> corners;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned k = 0; k < 3; ++k) corners[i][k] = static_cast<Real>(solid[i][k]);
    return corners;
}

template<class Real>
support::FourCornersOf<long double> exact(const Corners<Real>& corners) {
    support::FourCornersOf<long double> solid;
    for (unsigned i = 0; i < 4; ++i) solid[i] = Exact(corners[i][0], corners[i][1], corners[i][2]);
    return solid;
}

template<class Real>
Exact exact(const std::array<Real, 3>& a) {
    return {a[0], a[1], a[2]};
}

long double longest_edge(const support::FourCornersOf<long double>& solid) {
    long double most = 0;
    for (const auto& p : solid)
        for (const auto& q : solid) most = std::max(most, (p - q).norm());
    return most;
}

/// How far a tetrahedron is behind a plane, at least: 0 at the closest point to it.
long double behind(const support::FourCornersOf<long double>& solid, const Exact& point,
                   const Exact& normal) {
    long double least = std::numeric_limits<long double>::infinity();
    for (const auto& p : solid) least = std::min(least, normal.dot(point - p));
    return least;
}

template<class Real>
constexpr double u = std::numeric_limits<Real>::epsilon() / 2;

/// Largest errors over pairs that are apart: in units of u times the longer edge; `length` in units of u.
struct Errors {
    long double distance = 0, support = 0, length = 0;
    std::size_t apart = 0, meeting = 0, lost = 0, beyond = 0;

    void join(const Errors& other) {
        distance = std::max(distance, other.distance);
        support = std::max(support, other.support);
        length = std::max(length, other.length);
        apart += other.apart, meeting += other.meeting, lost += other.lost, beyond += other.beyond;
    }
};

template<class Real>
std::vector<Contact<Real>> rows_of(const Corners<Real>& a, const Corners<Real>& b, double margin,
                                   ContactCounts& counts) {
    return reference_contacts<Real>(
        {a}, {b}, counts,
        {.rule = ContactRule::distance, .decision = DecisionPrecision::exact, .margin = margin});
}

template<class Real>
void measure(const Corners<Real>& a, const Corners<Real>& b, double margin, Errors& errors) {
    ContactCounts counts;
    const auto rows = rows_of(a, b, margin, counts);
    const auto exact_a = exact(a), exact_b = exact(b);
    if (counts.rejected == 0) {
        errors.meeting += counts.degenerate == 0 ? 1 : 0;
        errors.lost += rows.size() + counts.degenerate == 1 ? 0 : 1;
        return;
    }
    ++errors.apart;
    const auto truth = support::distance_between(exact_a, exact_b);
    const auto unit = u<Real> * std::max(longest_edge(exact_a), longest_edge(exact_b));
    if (rows.empty()) {
        errors.lost += truth <= margin ? 1 : 0;
        return;
    }
    const auto& row = rows.front();
    errors.beyond += truth > margin + 64 * (unit + u<Real> * truth) ? 1 : 0;
    errors.distance = std::max(errors.distance, std::abs(row.depth - truth) / unit);
    const Exact normal = exact(row.normal), point = exact(row.point);
    errors.length = std::max(errors.length, std::abs(normal.norm() - 1) / u<Real>);
    if (truth < 1e4 * unit) return; // hardly more than what rounding leaves of a direction
    // Points have the coordinates' own rounding.
    const auto place = u<Real> * point.cwiseAbs().maxCoeff();
    errors.support =
        std::max({errors.support, std::abs(behind(exact_a, point, normal)) / (unit + place),
                  std::abs(behind(exact_b, point + normal * row.depth, -normal)) / (unit + place)});
}

template<class Real>
Errors errors_of(Family family, std::size_t pairs) {
    constexpr std::size_t block = 1000;
    std::vector<Errors> parts((pairs + block - 1) / block);
    parallel_for(parts.size(), [&](std::size_t i) {
        Random random(1000 * static_cast<std::uint64_t>(family) + 1000003 * i);
        for (std::size_t k = 0; k < std::min(block, pairs - block * i); ++k) {
            const auto [a, b] = make(random, family);
            measure(rounded<Real>(a), rounded<Real>(b), power_of_ten(random, -7, 0.5), parts[i]);
        }
    });
    Errors errors;
    for (const auto& part : parts) errors.join(part);
    return errors;
}

template<class Real>
class ContactsDistance : public testing::Test {};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsDistance, Reals);

/// The long form has 10^7 pairs in both precisions together.
TYPED_TEST(ContactsDistance, HardPairsAreMeasuredAndNoneIsLostLong) {
    const std::size_t pairs = support::long_form() ? 560000 : 3000;
    for (int i = 0; i < families; ++i) {
        SCOPED_TRACE("family " + std::to_string(i));
        const auto errors = errors_of<TypeParam>(static_cast<Family>(i), pairs);
        EXPECT_EQ(errors.lost, 0u);
        EXPECT_EQ(errors.beyond, 0u);
        EXPECT_LE(errors.distance, 8);
        EXPECT_LE(errors.length, 4);
        EXPECT_LE(errors.support, 32);
        if (static_cast<Family>(i) == Family::nested)
            EXPECT_GE(errors.meeting, pairs - pairs / 1000) << "a few are flat";
        else
            EXPECT_GT(errors.apart, pairs / 2);
    }
}

/// Corners of a tetrahedron in another order, and the bits of its corners in that of the original.
using Order = std::array<unsigned, 4>;

template<class Real>
Corners<Real> reordered(const Corners<Real>& corners, const Order& order) {
    return {corners[order[0]], corners[order[1]], corners[order[2]], corners[order[3]]};
}

unsigned original(unsigned bits, const Order& order) {
    unsigned result = 0;
    for (unsigned i = 0; i < 4; ++i) result |= (bits >> i & 1u) << order[i];
    return result;
}

TYPED_TEST(ContactsDistance, OrderOfCornersAndTetrahedraChangesNamesOnly) {
    constexpr double margin = 1;
    std::size_t seen = 0;
    for (int i = 0; i < families - 1; ++i) { // equal corners of the last have no order
        Random random(77);
        Order order_a{0, 1, 2, 3}, order_b{3, 1, 0, 2};
        for (int k = 0; k < 240; ++k) {
            const auto pair = make(random, static_cast<Family>(i));
            const auto a = rounded<TypeParam>(pair.first), b = rounded<TypeParam>(pair.second);
            ContactCounts counts, other_counts;
            const auto expected = rows_of(a, b, margin, counts);
            auto found = rows_of(reordered(a, order_a), reordered(b, order_b), margin, other_counts);
            for (auto& row : found)
                row.feature = original(row.feature & 15u, order_a) | original(row.feature >> 4, order_b) << 4;
            ASSERT_EQ(found, expected) << "family " << i << " pair " << k;
            ASSERT_EQ(counts, other_counts);
            other_counts = {};
            found = rows_of(b, a, margin, other_counts);
            ASSERT_EQ(found.size(), expected.size());
            ASSERT_EQ(counts, other_counts);
            for (std::size_t row = 0; row < found.size(); ++row) {
                const auto &p = found[row], &q = expected[row];
                EXPECT_EQ(p.depth, q.depth);
                EXPECT_EQ(p.feature, (q.feature & 15u) << 4 | q.feature >> 4);
                for (unsigned axis = 0; axis < 3; ++axis) {
                    EXPECT_EQ(p.normal[axis], TypeParam(0) - q.normal[axis]);
                    EXPECT_NEAR(p.point[axis], double{q.point[axis] + q.normal[axis] * q.depth},
                                16 * u<TypeParam> * (4 + std::abs(double{q.point[axis]})));
                }
            }
            seen += expected.size();
            std::next_permutation(order_a.begin(), order_a.end());
            if (k % 5 == 0) std::next_permutation(order_b.begin(), order_b.end());
        }
    }
    EXPECT_GT(seen, 1000u);
}

/// Corner 3 of A points up at the origin, and edge 0 1 of A is below.
template<class Real>
constexpr Corners<Real> below{{{-1, -1, -1}, {1, -1, -1}, {0, 1, -1}, {0, 0, 0}}};
/// A flat roof upside down: corners 0 1 2 in z = 0.
template<class Real>
constexpr Corners<Real> above{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, 1}}};

TYPED_TEST(ContactsDistance, KnownPairsHaveTheirFeaturesAndNumbers) {
    using Real = TypeParam;
    const auto lifted = [](Corners<Real> corners, Real x, Real y, Real z) {
        return moved<Real>(corners, {x, y, z});
    };
    const auto expect = [](const Corners<Real>& b, double distance, std::array<double, 3> point,
                           std::array<double, 3> normal, unsigned feature) {
        SCOPED_TRACE(feature);
        ContactCounts counts;
        const auto rows = rows_of(below<Real>, b, 2, counts);
        ASSERT_EQ(rows.size(), 1u);
        EXPECT_NEAR(rows[0].depth, distance, 4 * u<Real>);
        EXPECT_EQ(rows[0].feature, feature);
        for (unsigned k = 0; k < 3; ++k) {
            EXPECT_NEAR(rows[0].point[k], point[k], 4 * u<Real>);
            EXPECT_NEAR(rows[0].normal[k], normal[k], 4 * u<Real>);
        }
        EXPECT_TRUE(rows_of(below<Real>, b, distance * 0.9999, counts).empty());
    };
    constexpr unsigned of_b = 4; // bits of B's corners
    const double half = std::sqrt(0.5);
    expect(lifted(above<Real>, 0, 0, Real(0.25)), 0.25, {0, 0, 0}, {0, 0, 1}, 8 | 7 << of_b);
    // B's edge 0 1 is 0.5 beyond A's highest corner and 0.5 above it; then B's corner 0.
    expect(lifted(above<Real>, 0, Real(1.5), Real(0.5)), half, {0, 0, 0}, {0, half, half}, 8 | 3 << of_b);
    expect(lifted(above<Real>, Real(1.5), Real(1.5), Real(0.5)), std::sqrt(0.75), {0, 0, 0},
           {std::sqrt(1 / 3.), std::sqrt(1 / 3.), std::sqrt(1 / 3.)}, 8 | 1 << of_b);
    // Two edges that cross: B's lowest is along y, over A's along x.
    const Corners<Real> roof{{{-1, 0, 0}, {1, 0, 0}, {0, 1, -1}, {0, -1, -1}}};
    const Corners<Real> keel{{{0, -1, Real(0.5)}, {0, 1, Real(0.5)}, {1, 0, 2}, {-1, 0, 2}}};
    ContactCounts counts;
    const auto rows = rows_of(roof, keel, 1, counts);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].depth, Real(0.5));
    EXPECT_EQ(rows[0].feature, 3u | 3u << of_b);
    EXPECT_EQ(rows[0].point, (std::array<Real, 3>{0, 0, 0}));
    EXPECT_EQ(rows[0].normal, (std::array<Real, 3>{0, 0, 1}));
}

/// A corner that moves down through a face: the signed distance is its height, without a step at 0.
TYPED_TEST(ContactsDistance, IsContinuousWhereTheTwoMeet) {
    using Real = TypeParam;
    for (int i = -64; i <= 64; ++i) {
        const auto height = static_cast<Real>(i) / 1024;
        const auto b = moved<Real>(above<Real>, {Real(0.0625), Real(0.03125), height});
        ContactCounts counts;
        const auto rows = rows_of(below<Real>, b, 1, counts);
        ASSERT_EQ(rows.size(), 1u) << i;
        EXPECT_NEAR(rows[0].depth, height, 8 * u<Real>) << i;
        EXPECT_NEAR(rows[0].normal[2], 1, 8 * u<Real>) << i;
        EXPECT_EQ(rows[0].feature, 8u | 7u << 4) << i;
        EXPECT_NEAR(rows[0].point[2], 0, 8 * u<Real>) << i;
    }
}

/// Parallel faces at the margin, and at its neighbours.
TYPED_TEST(ContactsDistance, PairsAtTheMarginHaveRows) {
    using Real = TypeParam;
    const Real margin = Real(0.0625);
    const auto rows_at = [&](Real height) {
        ContactCounts counts;
        const auto flipped = changed(above<Real>, [](Real x) { return -x; }); // corners 0 1 2 in z = 0
        return rows_of(flipped, moved<Real>(above<Real>, {Real(0.1), Real(0.2), height}), margin, counts)
            .size();
    };
    EXPECT_EQ(rows_at(margin), 1u);
    EXPECT_EQ(rows_at(std::nextafter(margin, Real(0))), 1u);
    EXPECT_EQ(rows_at(std::nextafter(margin, Real(1))), 1u) << "kept up to the error of a distance";
    EXPECT_EQ(rows_at(static_cast<Real>(double{margin} * (1 + 2048 * u<Real>))), 0u);
}

} // namespace
} // namespace tandem::unit_test::contacts_distance
