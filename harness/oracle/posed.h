// SPDX-License-Identifier: MIT
#pragma once

#include "harness/oracle/decision.h"
#include "harness/oracle/facets.h"
#include "scenes/scene.h"

#include <gmpxx.h>

namespace tandem::oracle {

/// Where a pose puts a point, without rounding: the rotation of q / |q| is M(q) / (q . q), rational in the
/// four numbers of q, which need not be of unit length but finite and not all zero.
Vector<mpq_class> posed_point(const Pose& pose, const Vector<double>& point);

Points<mpq_class> posed_corners(const Pose& pose, const TetraCorners& corners);

/// How two closed tetrahedra with rational corners lie to each other; those of no volume as in decision.h.
/// About 50 us for corners that doubles were posed to.
Relation relation(const Points<mpq_class>& a, const Points<mpq_class>& b);

} // namespace tandem::oracle
