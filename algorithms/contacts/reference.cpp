// SPDX-License-Identifier: MIT
#include "algorithms/contacts/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace tandem {

namespace {

template<class Real>
using Vector = std::array<Real, 3>;

constexpr unsigned edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
constexpr unsigned face_corners[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

template<class Real>
constexpr Real unit_roundoff = std::numeric_limits<Real>::epsilon() / 2;

template<class Real>
Vector<Real> operator-(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template<class Real>
Vector<Real> operator+(const Vector<Real>& a, const Vector<Real>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

template<class Real>
Vector<Real> operator*(const Vector<Real>& a, Real b) {
    return {a[0] * b, a[1] * b, a[2] * b};
}

template<class Real>
Vector<Real> operator/(const Vector<Real>& a, Real b) {
    return {a[0] / b, a[1] / b, a[2] / b};
}

template<class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
    const Real xy = a[0] * b[0] + a[1] * b[1];
    return xy + a[2] * b[2];
}

template<class Real>
Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
    Vector<Real> result;
    for (unsigned i = 0; i < 3; ++i) {
        const unsigned j = (i + 1) % 3, k = (i + 2) % 3;
        result[i] = a[j] * b[k] - a[k] * b[j];
    }
    return result;
}

template<class Real>
Real largest(const Vector<Real>& a) {
    return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

/// The power of two that takes `length` into [1, 2), bounded by the largest finite one.
template<class Real>
Real scale_of(Real length) {
    int exponent = 0;
    std::frexp(length, &exponent);
    return std::ldexp(Real(1), std::min(1 - exponent, std::numeric_limits<Real>::max_exponent - 1));
}

template<class Real>
struct Tetrahedron {
    Corners<Real> corners; ///< relative to A's first one and scaled
    Corners<Real> normals; ///< outward, of the face opposite each corner

    Real distance(unsigned face, const Vector<Real>& p) const {
        return dot(normals[face], p - corners[face_corners[face][0]]);
    }
};

/// Outward normals of any length, or nothing when the volume could be zero.
template<class Real>
std::optional<Corners<Real>> outward_normals(const Corners<Real>& world) {
    Vector<Real> extent;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto [low, high] =
            std::minmax({world[0][axis], world[1][axis], world[2][axis], world[3][axis]});
        extent[axis] = high - low;
    }
    const Real scale = scale_of(largest(extent));
    Corners<Real> corners;
    for (unsigned i = 0; i < 4; ++i) corners[i] = (world[i] - world[0]) * scale;
    extent = extent * scale;
    const Real determinant = dot(corners[1], cross(corners[2], corners[3]));
    if (std::abs(determinant) <= 48 * unit_roundoff<Real> * (extent[0] * extent[1] * extent[2]))
        return std::nullopt;
    Corners<Real> normals;
    for (unsigned face = 0; face < 4; ++face) {
        const auto& [first, second, third] = face_corners[face];
        Vector<Real> normal = cross(corners[second] - corners[first], corners[third] - corners[first]);
        if (largest(normal) == 0) return std::nullopt;
        const bool inward = face % 2 == 0 ? determinant < 0 : determinant > 0;
        normals[face] = inward ? normal * Real(-1) : normal;
    }
    return normals;
}

template<class Real>
Vector<Real> unit(const Vector<Real>& a) {
    const auto shorter = a / largest(a);
    return shorter / std::sqrt(dot(shorter, shorter));
}

template<class Real>
Real taxicab(const Vector<Real>& a) {
    return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]);
}

/// One pair, its contacts in the making.
template<class Real>
class ReferencePair {
public:
    /// False when the pair is degenerate.
    bool load(const Corners<Real>& a, const Corners<Real>& b) {
        const Real longest_allowed = std::ldexp(Real(1), std::numeric_limits<Real>::max_exponent - 5);
        origin_ = a[0];
        for (unsigned i = 0; i < 4; ++i) {
            solids_[0].corners[i] = a[i] - origin_;
            solids_[1].corners[i] = b[i] - origin_;
        }
        for (const auto& solid : solids_)
            for (const auto& corner : solid.corners)
                for (const Real value : corner) {
                    if (!std::isfinite(value) || std::abs(value) > longest_allowed) return false;
                    size_ = std::max(size_, std::abs(value));
                }
        scale_ = scale_of(size_);
        size_ *= scale_;
        for (auto& solid : solids_)
            for (auto& corner : solid.corners) corner = corner * scale_;
        const auto normals_a = outward_normals(a);
        const auto normals_b = outward_normals(b);
        if (!normals_a || !normals_b) return false;
        axes_ = {*normals_a, *normals_b};
        for (unsigned i = 0; i < 8; ++i) solids_[i / 4].normals[i % 4] = unit(axes_[i / 4][i % 4]);
        return true;
    }

    bool separated() const {
        for (const auto& axes : axes_)
            for (const auto& axis : axes)
                if (separated_along(largest(axis) < shortest ? axis * lengthen : axis)) return true;
        for (const auto& [i, j] : edge_ends)
            for (const auto& [k, l] : edge_ends) {
                const auto& a = solids_[0].corners;
                const auto& b = solids_[1].corners;
                if (separated_along(cross(a[j] - a[i], b[l] - b[k]))) return true;
            }
        return false;
    }

    std::vector<Contact<Real>> contacts(unsigned boundary_a, unsigned boundary_b) const {
        std::vector<Contact<Real>> result;
        const auto face = opposing(boundary_a, boundary_b);
        if (!face) return result;
        for (unsigned owner = 0; owner < 2; ++owner)
            for (unsigned corner = 0; corner < 4; ++corner)
                if (inside(solids_[1 - owner], solids_[owner].corners[corner], 4))
                    keep(result, *face, 4 * owner + corner, solids_[owner].corners[corner]);
        for (unsigned owner = 0; owner < 2; ++owner)
            for (unsigned edge = 0; edge < 6; ++edge)
                for (unsigned other = 0; other < 4; ++other)
                    if (const auto p = crossing(owner, edge, other))
                        keep(result, *face, 8 + 24 * owner + 4 * edge + other, *p);
        return result;
    }

private:
    Real tolerance() const { return 32 * unit_roundoff<Real> * size_; }

    bool separated_along(const Vector<Real>& axis) const {
        const Real norm = taxicab(axis);
        if (norm < shortest) return false;
        Vector<Real> along[4];
        for (unsigned i = 0; i < 4; ++i)
            along[i] = {dot(axis, solids_[0].corners[i]), dot(axis, solids_[1].corners[i]), 0};
        const auto [low_a, high_a] = std::minmax({along[0][0], along[1][0], along[2][0], along[3][0]});
        const auto [low_b, high_b] = std::minmax({along[0][1], along[1][1], along[2][1], along[3][1]});
        const Real enough = 12 * unit_roundoff<Real> * norm * size_;
        return low_b - high_a > enough || low_a - high_b > enough;
    }

    std::optional<unsigned> opposing(unsigned boundary_a, unsigned boundary_b) const {
        std::optional<unsigned> best;
        Real least = 0;
        for (unsigned a = 0; a < 4; ++a)
            for (unsigned b = 0; b < 4; ++b) {
                if ((boundary_a & 1u << a) == 0 || (boundary_b & 1u << b) == 0) continue;
                const Real value = dot(solids_[0].normals[a], solids_[1].normals[b]);
                if (best && value >= least) continue;
                best = a;
                least = value;
            }
        return best;
    }

    /// Whether p is behind all faces of the solid but `skipped`.
    bool inside(const Tetrahedron<Real>& solid, const Vector<Real>& p, unsigned skipped) const {
        for (unsigned face = 0; face < 4; ++face)
            if (face != skipped && solid.distance(face, p) > tolerance()) return false;
        return true;
    }

    std::optional<Vector<Real>> crossing(unsigned owner, unsigned edge, unsigned face) const {
        const auto& from = solids_[owner].corners[edge_ends[edge][0]];
        const auto& to = solids_[owner].corners[edge_ends[edge][1]];
        const auto& other = solids_[1 - owner];
        const Real ahead = other.distance(face, from);
        const Real behind = other.distance(face, to);
        if (std::min(std::abs(ahead), std::abs(behind)) <= tolerance()) return std::nullopt;
        if ((ahead > 0) == (behind > 0)) return std::nullopt;
        const Vector<Real> p = from + (to - from) * (ahead / (ahead - behind));
        return inside(other, p, face) ? std::optional(p) : std::nullopt;
    }

    void keep(std::vector<Contact<Real>>& result, unsigned face, unsigned feature,
              const Vector<Real>& p) const {
        const auto& a = solids_[0];
        const Real depth = a.distance(face, p);
        if (std::abs(depth) >= std::abs(a.distance(face, a.corners[face])) / 2) return;
        const Vector<Real> no_negative_zero{};
        result.push_back({feature, p / scale_ + origin_ + no_negative_zero,
                          a.normals[face] + no_negative_zero, depth / scale_ + Real(0)});
    }

    static inline const Real shortest = std::ldexp(Real(1), -96); ///< axis that is tried
    static inline const Real lengthen =
        std::ldexp(Real(1), std::numeric_limits<Real>::digits == 24 ? 64 : 978);

    std::array<Tetrahedron<Real>, 2> solids_;
    std::array<Corners<Real>, 2> axes_; ///< the normals before they are made unit vectors
    Vector<Real> origin_{};
    Real size_ = 0;
    Real scale_ = 1;
};

} // namespace

template<class Real>
std::vector<Contact<Real>> reference_contacts(const Corners<Real>& a, const Corners<Real>& b,
                                              unsigned boundary_a, unsigned boundary_b,
                                              ContactCounts& counts) {
    ReferencePair<Real> pair;
    if (!pair.load(a, b)) {
        ++counts.degenerate;
        return {};
    }
    if (pair.separated()) {
        ++counts.rejected;
        return {};
    }
    return pair.contacts(boundary_a, boundary_b);
}

template std::vector<Contact<float>> reference_contacts(const Corners<float>&, const Corners<float>&,
                                                        unsigned, unsigned, ContactCounts&);
template std::vector<Contact<double>> reference_contacts(const Corners<double>&, const Corners<double>&,
                                                         unsigned, unsigned, ContactCounts&);

} // namespace tandem
