// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"
#include "scenes/scene.h"

#include <gmpxx.h>

namespace tandem::oracle {

/// Where a pose puts a point, without rounding: the rotation of q / |q| is M(q) / (q . q), rational in the
/// four numbers of q, which need not be of unit length but finite and not all zero.
Vector<mpq_class> posed_point(const Pose& pose, const Vector<double>& point);

Points<mpq_class> posed_corners(const Pose& pose, const TetraCorners& corners);

/// How two closed tetrahedra with rational corners lie to each other; those of no volume as in decision.h.
/// `unsure`: what a filter left; other facets have a negative gap. About 50 us for corners that doubles were
/// posed to.
Decision decide(const Points<mpq_class>& a, const Points<mpq_class>& b, FacetSet unsure = all_facets);

inline Relation relation(const Points<mpq_class>& a, const Points<mpq_class>& b) {
    return decide(a, b).relation;
}

/// A tetrahedron that is known exactly as a pose and corners in its body's frame.
struct Posed {
    TetraCorners near;          ///< about where its corners are in the world
    double off = 0;             ///< a coordinate of `near` is off by so much at most
    TetraCorners own;           ///< its corners in the body's frame, in the same order
    const Pose* pose = nullptr; ///< null: `own` is in the world
};

/// How they lie to each other where the poses put them exactly: by the filter with the slack of `near`, then
/// by rationals.
Decision decide(const Posed& a, const Posed& b);

} // namespace tandem::oracle
