// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/decision.h"
#include "geometry/facets.h"
#include "scenes/scene.h"

#include <gmpxx.h>

namespace tandem::oracle {

using namespace geometry;

/// The image of a point under a pose, without rounding. The rotation of q / |q| is M(q) / (q . q), which is
/// rational in the four numbers of q. q need not have unit length; it must be finite and not zero.
Vector<mpq_class> posed_point(const Pose& pose, const Vector<double>& point);

Points<mpq_class> posed_corners(const Pose& pose, const TetraCorners& corners);

/// The relation of two closed tetrahedra with rational corners; decision.h defines it for zero volume.
/// `unsure` lists the facets that a filter left undecided; the others must have a negative gap. About 50 us
/// for posed corners in double.
Decision decide(const Points<mpq_class>& a, const Points<mpq_class>& b, FacetSet unsure = all_facets);

inline Relation relation(const Points<mpq_class>& a, const Points<mpq_class>& b) {
    return decide(a, b).relation;
}

/// A tetrahedron that a pose and corners in the body's frame define exactly.
struct Posed {
    TetraCorners near;          ///< approximate corners in the world
    double off = 0;             ///< error bound of the coordinates of `near`
    TetraCorners own;           ///< exact corners in the body's frame, in the same order
    const Pose* pose = nullptr; ///< null: `own` is in world coordinates
};

/// The relation of two exactly posed tetrahedra: a filter with the error bound of `near`, then rationals.
Decision decide(const Posed& a, const Posed& b);

} // namespace tandem::oracle
