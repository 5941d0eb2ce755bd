// SPDX-License-Identifier: MIT
// Rule pressure against polygons in rationals: no polygon of any size is lost, area, centroid, normal and
// pressure err by a few roundings, and the order of corners and tetrahedra changes nothing but names.
#include "tests/support/long_form.h"
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "base/parallel.h"
#include "base/random.h"
#include "geometry/exact_polygon.h"

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
    Vector apart, turned;
    for (unsigned k = 0; k < 3; ++k) {
        apart[k] = row.point[k] - truth->centroid[k];
        turned[k] = row.normal[k] - truth->normal[k];
    }
    keep(errors.normal, turned.norm() / (shift / size));
    const double place =
        u<Real> * std::max({std::abs(row.point[0]), std::abs(row.point[1]), std::abs(row.point[2])});
    // The centroid moves by what the area may lose.
    const double spread = 1 + size * size / truth->area;
    keep(errors.centroid, apart.norm() / (shift * spread + place));
    const double most =
        std::max(*std::ranges::max_element(a.pressures), *std::ranges::max_element(b.pressures));
    const double least = std::min(height_of(solid_of(a)), height_of(solid_of(b)));
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
class ContactsPressure : public testing::Test {};

using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(ContactsPressure, Reals);

TYPED_TEST(ContactsPressure, PolygonsAreThoseOfRationalsLong) {
    const std::size_t pairs = support::long_form() ? 100000 : 2000;
    for (int family = 0; family < families; ++family) {
        const auto errors = errors_of<TypeParam>(static_cast<Family>(family), pairs);
        std::printf(
            "%d: rows %zu of %zu area %.3g centroid %.3g normal %.3g pressure %.3g lost %.3g extra %.3g\n",
            family, errors.rows, errors.polygons, errors.area, errors.centroid, errors.normal,
            errors.pressure, errors.lost, errors.extra);
    }
}

} // namespace
} // namespace tandem::unit_test::contacts_pressure
