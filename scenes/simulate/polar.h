// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

namespace tandem::simulate {

/// The rotation R (det +1) that maximises tr(R'F). It is the rotational factor of F when det F > 0, and the
/// closest rotation to F when F is inverted or flat. Uses Newton's iteration where it converges (Higham,
/// "Computing the polar decomposition", SIAM J. Sci. Stat. Comput. 7(4), 1986). Otherwise finds the dominant
/// eigenvector of a symmetric 4x4 matrix (Horn, "Closed-form solution of absolute orientation using unit
/// quaternions", J. Opt. Soc. Am. A 4(4), 1987) by Jacobi's rotations. Uses IEEE operations only.
Eigen::Matrix3d closest_rotation(const Eigen::Matrix3d& f);

} // namespace tandem::simulate
