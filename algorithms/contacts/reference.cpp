// SPDX-License-Identifier: MIT
#include "algorithms/contacts/reference.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace tandem {

namespace {

template<class Real>
using Vector = std::array<Real, 3>;

template<class Real>
Vector<Real> operator-(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template<class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template<class Real>
Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template<class Real>
Real extent(const Vector<Real>& v) {
    return std::max({std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
}

constexpr int edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr int faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/// One tetrahedron of the pair with the plane of each face.
template<class Real>
struct Shape {
    static constexpr Real unit = std::numeric_limits<Real>::epsilon() / 2;

    Corners<Real> corners;
    std::array<Vector<Real>, 4> normals{};

    bool finish() {
        std::array<Vector<Real>, 3> sides;
        Real longest = 0;
        for (int i = 0; i < 3; ++i) {
            sides[i] = corners[i + 1] - corners[0];
            longest = std::max(longest, extent(sides[i]));
        }
        const Real volume = dot(sides[0], cross(sides[1], sides[2]));
        if (!(std::fabs(volume) > 48 * unit * (longest * longest * longest))) return false;
        for (int f = 0; f < 4; ++f) {
            const auto& first = corners[faces[f][0]];
            auto normal = cross(corners[faces[f][1]] - first, corners[faces[f][2]] - first);
            Real length = std::sqrt(dot(normal, normal));
            if (!(length > 0)) return false;
            if (dot(normal, corners[f] - first) > 0) length = -length;
            for (auto& x : normal) x /= length;
            normals[f] = normal;
        }
        return true;
    }

    Real distance(int face, const Vector<Real>& p) const {
        return dot(normals[face], p - corners[faces[face][0]]);
    }

    bool holds(const Vector<Real>& p, int ignored, Real size) const {
        for (int f = 0; f < 4; ++f)
            if (f != ignored && !(distance(f, p) <= 32 * unit * size)) return false;
        return true;
    }

    std::optional<Vector<Real>> cut_by(const Shape& other, int edge, int face, Real size) const {
        const auto& p = corners[edges[edge][0]];
        const auto& q = corners[edges[edge][1]];
        const Real from = other.distance(face, p);
        const Real to = other.distance(face, q);
        if (!(std::min(from, to) < 0 && std::max(from, to) > 0)) return std::nullopt;
        const Real part = from / (from - to);
        Vector<Real> at;
        for (int i = 0; i < 3; ++i) at[i] = p[i] + part * (q[i] - p[i]);
        if (!other.holds(at, face, size)) return std::nullopt;
        return at;
    }
};

template<class Real>
bool apart_along(const Shape<Real>& a, const Shape<Real>& b, const Vector<Real>& axis, Real size) {
    std::array<Real, 4> at_a, at_b;
    for (int i = 0; i < 4; ++i) {
        at_a[i] = dot(axis, a.corners[i]);
        at_b[i] = dot(axis, b.corners[i]);
    }
    const auto [low_a, high_a] = std::minmax_element(at_a.begin(), at_a.end());
    const auto [low_b, high_b] = std::minmax_element(at_b.begin(), at_b.end());
    const Real norm = std::fabs(axis[0]) + std::fabs(axis[1]) + std::fabs(axis[2]);
    const Real margin = 16 * Shape<Real>::unit * (norm * size);
    return *low_b - *high_a > margin || *low_a - *high_b > margin;
}

template<class Real>
bool apart(const Shape<Real>& a, const Shape<Real>& b, Real size) {
    std::vector<Vector<Real>> axes(a.normals.begin(), a.normals.end());
    axes.insert(axes.end(), b.normals.begin(), b.normals.end());
    for (const auto& [a0, a1] : edges)
        for (const auto& [b0, b1] : edges)
            axes.push_back(cross(a.corners[a1] - a.corners[a0], b.corners[b1] - b.corners[b0]));
    return std::any_of(axes.begin(), axes.end(),
                       [&](const auto& axis) { return apart_along(a, b, axis, size); });
}

/// The face of a in the most opposing pair of boundary faces, or -1.
template<class Real>
int opposing_face(const Shape<Real>& a, const Shape<Real>& b, unsigned boundary_a, unsigned boundary_b) {
    int chosen = -1;
    Real least = std::numeric_limits<Real>::infinity();
    for (int i = 0; i < 16; ++i) {
        if ((boundary_a >> (i / 4) & 1) == 0 || (boundary_b >> (i % 4) & 1) == 0) continue;
        const Real facing = dot(a.normals[i / 4], b.normals[i % 4]);
        if (facing < least) {
            least = facing;
            chosen = i / 4;
        }
    }
    return chosen;
}

template<class Real>
std::optional<Vector<Real>> feature_point(const Shape<Real>& a, const Shape<Real>& b, unsigned feature,
                                          Real size) {
    const int i = static_cast<int>(feature);
    if (i < 4) return b.holds(a.corners[i], -1, size) ? std::optional(a.corners[i]) : std::nullopt;
    if (i < 8) return a.holds(b.corners[i - 4], -1, size) ? std::optional(b.corners[i - 4]) : std::nullopt;
    if (i < 32) return a.cut_by(b, (i - 8) / 4, (i - 8) % 4, size);
    return b.cut_by(a, (i - 32) / 4, (i - 32) % 4, size);
}

std::uint64_t split_mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

template<class Real>
std::uint64_t bits_of(Real value) {
    if constexpr (std::is_same_v<Real, double>)
        return std::bit_cast<std::uint64_t>(value);
    else
        return std::bit_cast<std::uint32_t>(value);
}

} // namespace

template<class Real>
std::vector<Contact<Real>> reference_contacts(const Corners<Real>& world_a, const Corners<Real>& world_b,
                                              unsigned boundary_a, unsigned boundary_b,
                                              ContactCounts& counts) {
    const auto origin = world_a[0];
    Shape<Real> a, b;
    Real size = 0;
    bool finite = true;
    for (int i = 0; i < 4; ++i) {
        a.corners[i] = world_a[i] - origin;
        b.corners[i] = world_b[i] - origin;
        for (const auto& v : {a.corners[i], b.corners[i]})
            for (const auto x : v) finite = finite && std::isfinite(x);
        size = std::max({size, extent(a.corners[i]), extent(b.corners[i])});
    }
    if (!finite || !a.finish() || !b.finish()) {
        ++counts.degenerate;
        return {};
    }
    if (apart(a, b, size)) {
        ++counts.rejected;
        return {};
    }
    const int face = opposing_face(a, b, boundary_a, boundary_b);
    if (face < 0) return {};
    const auto normal = a.normals[face];
    const auto base = a.corners[faces[face][0]];
    const Real half = std::fabs(dot(normal, a.corners[face] - base)) / 2;
    std::vector<Contact<Real>> contacts;
    for (unsigned feature = 0; feature < 56; ++feature) {
        const auto at = feature_point(a, b, feature, size);
        if (!at) continue;
        const Real depth = dot(normal, *at - base);
        if (!(std::fabs(depth) < half)) continue;
        Contact<Real> contact{feature, {}, {}, depth + 0};
        for (int i = 0; i < 3; ++i) {
            contact.point[i] = (*at)[i] + origin[i] + 0;
            contact.normal[i] = normal[i] + 0;
        }
        contacts.push_back(contact);
    }
    return contacts;
}

template<class Real>
std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t body_a, std::uint32_t tet_a,
                                                      std::uint32_t body_b, std::uint32_t tet_b,
                                                      const Contact<Real>& contact) {
    auto term =
        split_mix(split_mix(std::uint64_t{body_a} << 32 | tet_a) + (std::uint64_t{body_b} << 32 | tet_b));
    term = split_mix(term + contact.feature);
    for (const auto x : contact.point) term = split_mix(term + bits_of(x));
    for (const auto x : contact.normal) term = split_mix(term + bits_of(x));
    term = split_mix(term + bits_of(contact.depth));
    return {term, split_mix(term + 0x9e3779b97f4a7c15u)};
}

template std::vector<Contact<float>> reference_contacts(const Corners<float>&, const Corners<float>&,
                                                        unsigned, unsigned, ContactCounts&);
template std::vector<Contact<double>> reference_contacts(const Corners<double>&, const Corners<double>&,
                                                         unsigned, unsigned, ContactCounts&);
template std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t, std::uint32_t, std::uint32_t,
                                                               std::uint32_t, const Contact<float>&);
template std::pair<std::uint64_t, std::uint64_t> contact_terms(std::uint32_t, std::uint32_t, std::uint32_t,
                                                               std::uint32_t, const Contact<double>&);

} // namespace tandem
