// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bounds/geometry.h"
#include "scenes/scene.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace tandem {

/// What a body adds to the wrenches of a frame: the point in the coordinates of its vertices about which
/// torques are, and powers of two that are the units of sums.
struct BodyArm {
    std::array<double, 3> pivot{}; ///< the origin of a rigid body's mesh; of a deformable body (0, 0, 0)
    double size = 1;               ///< at least the extent of its mesh
    double reach = 1;              ///< at least the distance of its points from the pivot
    double pressure = 1;           ///< at least half of the largest pressure of its mesh
};

/// The error of a polygon that does not fit into the units of its bodies, or of a sum that is not finite.
inline constexpr std::string_view wrench_too_large =
    "output=wrenches: a sum exceeds the numbers of this precision, or a polygon what its bodies' meshes let "
    "expect, because a deformable body has grown to many times its size or lies more than 2^18 sizes from "
    "the "
    "origin; choose precision=double, other units or output=contacts";

/// By body. The points of deformable bodies may be 2^18 times their size from the origin.
std::vector<BodyArm> body_arms(const Scene& scene);

/// The rows of wrenches.cl: 8 reals a body. Throws InputError if the smallest sums that a body can take part
/// in are not normal numbers, so that they would lose digits.
std::vector<std::byte> packed_arms(const std::vector<BodyArm>& arms, const Geometry& geometry);

/// The polygons of a body pair added up as wrenches.cl does it, on the host. Real is float or double.
template<class Real>
class WrenchSums {
public:
    static constexpr std::size_t parts = 7; ///< force, torque, area

    /// `pose`: the 12 numbers of a's pose (pack.h), or of the identity.
    WrenchSums(const BodyArm& a, const BodyArm& b, const std::array<Real, 12>& pose);

    /// Adds a polygon. Throws InputError if it exceeds the units.
    void add(const std::array<Real, 3>& centroid, const std::array<Real, 3>& normal, Real area,
             Real pressure);
    /// Force on a, torque on a about its pivot, and area. Throws InputError if one is not finite.
    std::array<Real, parts> values() const;
    std::uint32_t polygons() const { return static_cast<std::uint32_t>(polygons_); }

private:
    void add_number(std::size_t part, Real number);

    std::array<Real, 3> pivot_{}; ///< in the coordinates of centroids
    Real area_, pressure_, reach_;
    std::array<std::int64_t, parts> whole_{}, rest_{};
    std::uint64_t polygons_ = 0;
};

} // namespace tandem
