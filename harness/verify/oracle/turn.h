// SPDX-License-Identifier: MIT
#pragma once

#include "geometry/meet_in_motion.h"
#include "scenes/scene.h"

#include <span>

namespace tandem::oracle {

/// The shorter rotation from one pose's rotation to another's, about one axis and at constant speed.
struct Turn {
    Eigen::Quaterniond first = Eigen::Quaterniond::Identity(); ///< the first rotation, normalised
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();           ///< in the world
    double angle = 0; ///< from 0 to pi; 0 only for equal rotations, whose quaternions may have opposite signs
    bool either = false; ///< 180 degrees within rounding, so that both ways are equally short

    Turn() = default;
    Turn(const Pose& from, const Pose& to);

    /// Sets angle, arcs and their error bound in a tetrahedron with these corners in the body's mesh.
    /// `other_way` turns about the opposite axis.
    void bend(MovingTetra& moving, std::span<const Eigen::Vector3d, 4> corners, bool other_way) const;

    /// How far the path of any of these vertices of the mesh leaves its chord at equal times, at most.
    double leaves_chord(std::span<const Eigen::Vector3d> vertices) const;
};

} // namespace tandem::oracle
