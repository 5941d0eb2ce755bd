// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/reference_pair.h"

namespace tandem::narrow_phase {

namespace {

/// A tetrahedron relative to its first corner, in the order of operations of certificate.clh.
template<class Real>
struct Solid {
    std::array<Vector<Real>, 3> normals; ///< inward, of the faces opposite corners 1 to 3
    Real volume = 0;                     ///< six times the volume
    Real length = 0;                     ///< longest component of an edge from the first corner

    explicit Solid(const Corners<Real>& corners) {
        std::array<Vector<Real>, 3> edge;
        for (unsigned i = 0; i < 3; ++i) {
            edge[i] = corners[i + 1] - corners[0];
            length = std::max(length, largest(edge[i]));
        }
        volume = dot(edge[0], cross(edge[1], edge[2]));
        const Real sign = volume < 0 ? Real(-1) : Real(1);
        for (unsigned i = 0; i < 3; ++i) normals[i] = cross(edge[(i + 1) % 3], edge[(i + 2) % 3]) * sign;
        volume = volume * sign;
    }

    bool certain() const { return volume > 1024 * unit_roundoff<Real> * length * length * length; }
};

/// Distances [corner of the other][face] behind the faces of one tetrahedron, minus their error bound.
template<class Real>
struct Distances {
    std::array<std::array<Real, 4>, 4> behind;
    Real error;

    /// `corners`: of the other tetrahedron, relative to the first corner of this one.
    Distances(const Solid<Real>& solid, const Corners<Real>& corners, Real reach)
        : error(1024 * unit_roundoff<Real> * solid.length * solid.length * reach) {
        for (unsigned i = 0; i < 4; ++i) {
            std::array<Real, 3> d;
            for (unsigned face = 0; face < 3; ++face) d[face] = dot(solid.normals[face], corners[i]);
            behind[i] = {(solid.volume - ((d[0] + d[1]) + d[2])) - error, d[0] - error, d[1] - error,
                         d[2] - error};
        }
    }

    Real most(unsigned face) const {
        return std::max({behind[0][face], behind[1][face], behind[2][face], behind[3][face]});
    }
    bool apart() const {
        for (unsigned face = 0; face < 4; ++face)
            if (most(face) < -3 * error) return true;
        return false;
    }
    bool inside() const {
        return std::any_of(behind.begin(), behind.end(), [](const auto& corner) {
            return *std::min_element(corner.begin(), corner.end()) > 0;
        });
    }
    bool crossed() const {
        for (unsigned face = 0; face < 4; ++face)
            if (!(most(face) > 0)) return false;
        return true;
    }
    /// Whether a corner, or a point between two corners, is behind both faces.
    bool entered(unsigned face, unsigned other) const {
        for (unsigned i = 0; i < 4; ++i)
            if (behind[i][face] > 0 && behind[i][other] > 0) return true;
        for (unsigned i = 1; i < 4; ++i)
            for (unsigned j = 0; j < i; ++j) {
                const bool turns =
                    std::signbit(behind[i][face] * behind[j][other] - behind[j][face] * behind[i][other]);
                const unsigned from = turns ? j : i, to = turns ? i : j;
                if (behind[from][face] > 0 && behind[to][other] > 0) return true;
            }
        return false;
    }
};

} // namespace

template<class Real>
unsigned certificate(const Corners<Real>& a, const Corners<Real>& b) {
    constexpr bool wide = sizeof(Real) == 8;
    const Solid<Real> first(a), second(b);
    Corners<Real> to_a, to_b;
    Real reach = first.length;
    for (unsigned i = 0; i < 4; ++i) {
        to_a[i] = a[i] - b[0];
        to_b[i] = b[i] - a[0];
        reach = std::max(reach, largest(to_b[i]));
    }
    const bool usable = std::min(first.length, second.length) >= std::ldexp(Real(1), wide ? -30 : -16)
                        && reach <= std::ldexp(Real(1), wide ? 30 : 19);
    if (!usable || !first.certain() || !second.certain()) return 0;
    const Distances<Real> of_a(second, to_a, reach), of_b(first, to_b, reach);
    if (of_a.apart() || of_b.apart()) return 1;
    if (of_a.inside() || of_b.inside()) return 2;
    bool entered = of_a.crossed();
    for (const auto& [i, j] : edge_ends) entered = entered && of_b.entered(i, j);
    return entered ? 2 : 0;
}

template unsigned certificate(const Corners<float>&, const Corners<float>&);
template unsigned certificate(const Corners<double>&, const Corners<double>&);

} // namespace tandem::narrow_phase
