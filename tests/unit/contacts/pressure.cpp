// SPDX-License-Identifier: MIT
// Rule pressure against polygons in rationals: no polygon of any size is lost, area, centroid, normal and
// pressure err by a few roundings, and the order of corners and tetrahedra changes nothing but names.
#include "tests/support/long_form.h"
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "base/parallel.h"
#include "base/random.h"
#include "geometry/exact_polygon.h"

#include <set>

namespace tandem::unit_test::contacts_pressure {
namespace {

using Vector = Eigen::Vector3d;
using Solid = std::array<Vector, 4>;
using Values = std::array<double, 4>;

/// How two tetrahedra of size 1 and their fields lie.
enum class Family {
    any,
    zero_on_a_face, ///< as at the boundary of a mesh
    through_corner, ///< the plane of equal pressure goes through corners
    through_edge,
    through_face,
    nearly_parallel, ///< gradients that differ by little
    sliver,
    small, ///< a much smaller B
    far,
    same_corners
};
constexpr int families = 10;

struct Given {
    Solid a, b;
    Values of_a, of_b;
};

Solid random_solid(Random& random) {
    Solid solid;
    for (auto& corner : solid)
        corner = Vector(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    return solid;
}

Values random_values(Random& random) {
    Values values;
    for (double& value : values) value = random.uniform(0, 1);
    return values;
}

/// A linear function that has `values` at the corners of a solid.
struct Linear {
    Vector gradient;
    double at_origin;

    Linear(const Solid& solid, const Values& values) {
        Eigen::Matrix4d rows;
        for (int i = 0; i < 4; ++i) rows.row(i) << solid[static_cast<std::size_t>(i)].transpose(), 1;
        const Eigen::Vector4d found = rows.fullPivLu().solve(Eigen::Vector4d(values.data()));
        gradient = found.head<3>();
        at_origin = found[3];
    }
    double operator()(const Vector& p) const { return gradient.dot(p) + at_origin; }
};

/// Makes the pressures of A's first `corners` corners those of B's field.
void meet_at_corners(Given& pair, std::size_t corners) {
    const Linear field(pair.b, pair.of_b);
    for (std::size_t i = 0; i < corners; ++i) pair.of_a[i] = field(pair.a[i]);
}

Given make(Random& random, Family family) {
    Given pair{random_solid(random), random_solid(random), random_values(random), random_values(random)};
    switch (family) {
    case Family::zero_on_a_face:
        for (auto* values : {&pair.of_a, &pair.of_b}) *values = {0, 0, 0, random.uniform(0.1, 1)};
        break;
    case Family::through_corner:
    case Family::through_edge:
    case Family::through_face:
        meet_at_corners(pair, 1 + static_cast<std::size_t>(family)
                                  - static_cast<std::size_t>(Family::through_corner));
        break;
    case Family::nearly_parallel: {
        meet_at_corners(pair, 4);
        const double change = std::exp(-12 * random.uniform(0, 1));
        for (double& value : pair.of_a) value += random.uniform(-change, change);
        break;
    }
    case Family::sliver:
        for (auto& p : pair.a) p.z() *= 1e-4;
        for (auto& p : pair.b) p.x() *= 1e-4;
        break;
    case Family::small:
        for (auto& p : pair.b) p *= 1e-3;
        break;
    case Family::same_corners:
        pair.b = pair.a;
        break;
    case Family::any:
    case Family::far:
        break;
    }
    const auto turn = random.rotation();
    const double reach = family == Family::far ? 1000 : 0;
    const Vector place = reach * Vector(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    for (auto* solid : {&pair.a, &pair.b})
        for (auto& p : *solid) p = turn * p + place;
    return pair;
}

template<class Real>
GivenTetrahedron<Real> rounded(const Solid& solid, const Values& values) {
    GivenTetrahedron<Real> given{};
    for (unsigned i = 0; i < 4; ++i) {
        for (unsigned k = 0; k < 3; ++k) given.corners[i][k] = static_cast<Real>(solid[i][k]);
        given.pressures[i] = static_cast<Real>(values[i]);
    }
    return given;
}

template<class Real>
TetraCorners widened(const GivenTetrahedron<Real>& given) {
    TetraCorners corners;
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned k = 0; k < 3; ++k) corners[i][k] = given.corners[i][k];
    return corners;
}

template<class Real>
Values pressures_of(const GivenTetrahedron<Real>& given) {
    return {given.pressures[0], given.pressures[1], given.pressures[2], given.pressures[3]};
}

template<class Real>
Solid solid_of(const GivenTetrahedron<Real>& given) {
    Solid solid;
    for (unsigned i = 0; i < 4; ++i)
        solid[i] = {given.corners[i][0], given.corners[i][1], given.corners[i][2]};
    return solid;
}

template<class Real>
Contact<double> widened(const Contact<Real>& row) {
    const auto& [feature, p, n, area, pressure] = row;
    return {feature, {p[0], p[1], p[2]}, {n[0], n[1], n[2]}, area, pressure};
}

template<class Real>
std::vector<Contact<Real>> rows_of(const GivenTetrahedron<Real>& a, const GivenTetrahedron<Real>& b) {
    ContactCounts counts;
    return reference_contacts(a, b, counts,
                              {.rule = ContactRule::pressure, .decision = DecisionPrecision::exact});
}

double longest_edge(const Solid& solid) {
    double most = 0;
    for (const auto& p : solid)
        for (const auto& q : solid) most = std::max(most, (p - q).norm());
    return most;
}

double height_of(const Solid& solid) {
    double least = std::numeric_limits<double>::infinity();
    for (unsigned i = 0; i < 4; ++i) {
        const auto &p = solid[(i + 1) % 4], &q = solid[(i + 2) % 4], &r = solid[(i + 3) % 4];
        least = std::min(least, std::abs((q - p).cross(r - p).normalized().dot(solid[i] - p)));
    }
    return least;
}

/// How far rounding can shift the plane of equal pressure, in units of roundoff: the error of a gradient is
/// that of a pressure over a height, and the difference of the gradients divides it.
template<class Real>
double shift_of(const GivenTetrahedron<Real>& a, const GivenTetrahedron<Real>& b) {
    const auto solid_a = solid_of(a), solid_b = solid_of(b);
    const double most =
        std::max(*std::ranges::max_element(a.pressures), *std::ranges::max_element(b.pressures));
    const double steepest = most / std::min(height_of(solid_a), height_of(solid_b));
    const double difference =
        (Linear(solid_a, pressures_of(a)).gradient - Linear(solid_b, pressures_of(b)).gradient).norm();
    const double size = std::max(longest_edge(solid_a), longest_edge(solid_b));
    return size * std::max(1.0, steepest / difference);
}

template<class Real>
constexpr double u = std::numeric_limits<Real>::epsilon() / 2;

/// Largest errors, in units of u times what a shift of the plane changes.
struct Errors {
    double area = 0, centroid = 0, normal = 0, pressure = 0, lost = 0, extra = 0;
    std::size_t rows = 0, polygons = 0;

    void join(const Errors& other) {
        for (double Errors::*member : {&Errors::area, &Errors::centroid, &Errors::normal, &Errors::pressure,
                                       &Errors::lost, &Errors::extra})
            this->*member = std::max(this->*member, other.*member);
        rows += other.rows;
        polygons += other.polygons;
    }
};

template<class Real>
void measure(const Given& pair, Errors& errors) {
    const auto a = rounded<Real>(pair.a, pair.of_a), b = rounded<Real>(pair.b, pair.of_b);
    const auto truth = exact_polygon(widened(a), pressures_of(a), widened(b), pressures_of(b));
    const auto rows = rows_of(a, b);
    const double size = std::min(longest_edge(solid_of(a)), longest_edge(solid_of(b)));
    const double shift = u<Real> * shift_of(a, b);
    errors.polygons += truth ? 1 : 0;
    errors.rows += rows.size();
    const auto keep = [](double& most, double error) { most = std::max(most, error); };
    if (!truth || rows.empty()) {
        if (truth) keep(errors.lost, truth->area / (shift * size));
        if (!rows.empty()) keep(errors.extra, widened(rows.front()).depth / (shift * size));
        return;
    }
    const auto row = widened(rows.front());
    keep(errors.area, std::abs(row.depth - truth->area) / (shift * size));
    const double least = std::min(height_of(solid_of(a)), height_of(solid_of(b)));
    Vector apart, turned;
    for (unsigned k = 0; k < 3; ++k) {
        apart[k] = row.point[k] - truth->centroid[k];
        turned[k] = row.normal[k] - truth->normal[k];
    }
    keep(errors.normal, turned.norm() / (shift / least));
    const double place =
        u<Real> * std::max({std::abs(row.point[0]), std::abs(row.point[1]), std::abs(row.point[2])});
    // The centroid moves by what the area may lose.
    const double spread = 1 + size * size / truth->area;
    keep(errors.centroid, apart.norm() / (shift * spread + place));
    const double most =
        std::max(*std::ranges::max_element(a.pressures), *std::ranges::max_element(b.pressures));
    keep(errors.pressure, std::abs(row.pressure - truth->pressure) / (most * (shift * spread / least)));
}

template<class Real>
Errors errors_of(Family family, std::size_t pairs) {
    constexpr std::size_t block = 100;
    std::vector<Errors> parts((pairs + block - 1) / block);
    parallel_for(parts.size(), [&](std::size_t i) {
        Random random(1000 * static_cast<std::uint64_t>(family) + 1000003 * i);
        for (std::size_t k = 0; k < block; ++k) measure<Real>(make(random, family), parts[i]);
    });
    Errors errors;
    for (const auto& part : parts) errors.join(part);
    return errors;
}

template<class Real>
class ContactsPressureOf : public testing::Test {};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsPressureOf, Reals);

TYPED_TEST(ContactsPressureOf, PolygonsAreThoseOfRationalsLong) {
    const std::size_t pairs = support::long_form() ? 100000 : 2000;
    for (int i = 0; i < families; ++i) {
        SCOPED_TRACE(i);
        const auto family = static_cast<Family>(i);
        const auto errors = errors_of<TypeParam>(family, pairs);
        EXPECT_GT(errors.polygons, pairs / 20);
        EXPECT_LT(errors.normal, 128);
        // Rounding decides on which side of a face's plane the plane of equal pressure lies.
        if (family == Family::through_face) continue;
        // Over 10^5 pairs of each family at most 3600, 400, 0.5, 100 and 540: the units are rough.
        EXPECT_LT(errors.area, 16384);
        EXPECT_LT(errors.centroid, 2048);
        EXPECT_LT(errors.pressure, 4);
        EXPECT_LT(errors.lost, 2048);
        EXPECT_LT(errors.extra, 2048);
    }
}

template<class Real>
GivenTetrahedron<Real> reordered(const GivenTetrahedron<Real>& given, const std::array<unsigned, 4>& order) {
    auto result = given;
    for (unsigned i = 0; i < 4; ++i) {
        result.corners[i] = given.corners[order[i]];
        result.pressures[i] = given.pressures[order[i]];
    }
    return result;
}

TYPED_TEST(ContactsPressureOf, OrderOfCornersAndTetrahedraChangesNothingElse) {
    Random random(5);
    std::size_t polygons = 0;
    for (int i = 0; i < 2000; ++i) {
        // Of tetrahedra with the same corners the given A stays the first.
        const auto pair = make(random, static_cast<Family>(i % (families - 1)));
        const auto a = rounded<TypeParam>(pair.a, pair.of_a), b = rounded<TypeParam>(pair.b, pair.of_b);
        const auto rows = rows_of(a, b);
        polygons += rows.size();
        EXPECT_EQ(rows_of(reordered(a, {2, 0, 3, 1}), reordered(b, {1, 0, 2, 3})), rows);
        auto swapped = rows_of(b, a);
        for (auto& row : swapped)
            for (auto& x : row.normal) x = -x + TypeParam(0);
        EXPECT_EQ(swapped, rows);
    }
    EXPECT_GT(polygons, 300u);
}

TYPED_TEST(ContactsPressureOf, EqualFieldsMakeNone) {
    Random random(6);
    for (int i = 0; i < 500; ++i) {
        auto pair = make(random, Family::any);
        const Vector gradient = random.direction();
        for (auto [solid, values] : {std::pair(&pair.a, &pair.of_a), {&pair.b, &pair.of_b}})
            for (std::size_t corner = 0; corner < 4; ++corner)
                (*values)[corner] = 2 + gradient.dot((*solid)[corner]);
        EXPECT_TRUE(rows_of(rounded<double>(pair.a, pair.of_a), rounded<double>(pair.b, pair.of_b)).empty());
        auto same = rounded<TypeParam>(pair.a, pair.of_a);
        EXPECT_TRUE(rows_of(same, same).empty());
        same.pressures = {1, 1, 1, 1};
        EXPECT_TRUE(rows_of(same, same).empty()) << "no gradients";
    }
}

// Two slabs that overlap by a half: the polygon is the triangle in the middle.
TEST(ContactsPressure, OfTwoFieldsThatRiseTowardsEachOtherItIsInTheMiddle) {
    const GivenTetrahedron<double> a{{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}}, 15, {0, 0, 0, 2}};
    const GivenTetrahedron<double> b{{{{0, 0, 2}, {2, 0, 2}, {0, 2, 2}, {0, 0, 0}}}, 15, {0, 0, 0, 2}};
    const auto rows = rows_of(a, b);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].feature, 3u);
    EXPECT_EQ(rows[0].normal, (std::array<double, 3>{0, 0, 1}));
    EXPECT_EQ(rows[0].depth, 0.5);
    EXPECT_EQ(rows[0].pressure, 1);
    EXPECT_DOUBLE_EQ(rows[0].point[0], 1. / 3);
    EXPECT_DOUBLE_EQ(rows[0].point[1], 1. / 3);
    EXPECT_EQ(rows[0].point[2], 1);
    const auto [corners, pressures] = polygon_of_equal_pressure(a, b);
    EXPECT_EQ(pressures, (std::vector<double>(3, 1)));
    EXPECT_EQ(std::set(corners.begin(), corners.end()),
              (std::set<std::array<double, 3>>{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}));
    EXPECT_TRUE(rows_of(b, b).empty());
    auto steep = b; // rises with a's field, and faster
    steep.pressures = {4, 4, 4, 0};
    EXPECT_TRUE(rows_of(a, steep).empty()) << "its normal is against a's gradient";
}

} // namespace
} // namespace tandem::unit_test::contacts_pressure
