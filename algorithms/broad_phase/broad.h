// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/ball.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/bodies/body_pair.h"
#include "algorithms/bodies/frame_input.h"

namespace tandem {

/// Finds body pairs on the host: sweep and prune over bounds of the bodies. The bounds are slabs along the
/// directions of the geometry, because bounds along other directions could drop pairs with overlapping
/// k-DOPs. They are widened by the rounding of transform and slabs, so that every pair with overlapping root
/// k-DOPs is found. Pairs without may_meet() (scenes/scene.h) are excluded. Setting self adds pairs (a, a).
/// Broad::sphere_boxes is the exception: its bounds are boxes along the coordinate axes, whatever the
/// geometry is. It finds every pair of bodies that meet, but not every pair with overlapping root k-DOPs.
class BroadSweep {
public:
    /// `bound`: Broad::sphere and sphere_boxes for spheres around meshes. Broad::tight for boxes in mesh
    /// coordinates of rigid bodies, and exact slabs of deformable bodies. `scene` must outlive this.
    BroadSweep(const Scene& scene, const Geometry& geometry, Broad bound, SelfPairs self = SelfPairs::off);

    /// Pairs in ascending order. O(n log n), plus the number of pairs that overlap along the sweep direction.
    std::vector<BodyPair> pairs(const FrameInput& input) const { return pairs(input, {}); }
    /// Pairs that may overlap while every vertex is within its body's skin of its position in the frame, or
    /// on its path to the frame's successor. Empty `skins`: 0 for all bodies.
    std::vector<BodyPair> pairs(const FrameInput& input, std::span<const double> skins) const;
    /// Pairs of bodies that are bounded by these balls.
    std::vector<BodyPair> pairs(std::span<const Ball> balls) const;

    /// Writes the bounds of one body in a frame, and on its path to the frame's successor: for each axis the
    /// lower and the upper end.
    void bound(const FrameInput& input, std::uint32_t body, double skin, double* slabs) const;
    std::size_t axes() const { return directions_.size(); }

private:
    struct Shape {
        Eigen::Vector3d centre, half;
        double radius = 0; ///< of the bounding sphere about `centre`
        double reach = 0;  ///< largest distance of a vertex from the mesh's origin
        double arm = 0;    ///< the same from the origin about which the mesh turns
    };

    void bound_in(const Frame& frame, std::uint32_t body, double skin, double* slabs) const;
    void add_path(const FrameInput& input, std::uint32_t body, double skin, double* slabs) const;
    std::vector<BodyPair> swept(const std::vector<double>& slabs) const;
    Shape shape_of(const std::vector<Eigen::Vector3d>& vertices,
                   const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) const;
    void bound_rigid(const Shape& shape, const Pose& pose, double* slabs) const;
    void bound_deformed(const std::vector<Eigen::Vector3d>& vertices, double* slabs) const;
    void widen(double* slabs, double skin) const;
    std::size_t sweep_direction(std::span<const double> slabs) const;
    std::vector<BodyPair> swept_by_world(const std::vector<double>& slabs) const;

    const Scene& scene_;
    std::vector<Eigen::Vector3d> directions_;
    Broad bound_;
    std::vector<BodyPair> own_; ///< the pairs (a, a)
    double roundoff_;
    double underflow_;          ///< error bound of a coordinate below the least normal number
    double margin_;             ///< by which kernels enlarge bounds, with their roundings
    double tolerance_;          ///< widening along unit directions for published rounding
    std::vector<Shape> shapes_; ///< by mesh
};

} // namespace tandem
