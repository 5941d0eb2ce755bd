// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/ball.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/traversal.h"

namespace tandem {

/// Finds body pairs whose volumes may overlap, on the host: slabs of a simple bound of each body along the
/// geometry's own directions, swept along the direction that spreads the bodies most. Bounds along any other
/// directions could drop pairs whose k-DOPs overlap. Widened by the rounding of transform and slabs, so no
/// pair whose root k-DOPs overlap is ever dropped. Pairs of two fixed bodies are left out.
class BroadSweep {
public:
    /// `bound`: Broad::sphere, the paper's spheres around meshes; or Broad::tight, boxes of the meshes'
    /// frames and the own slabs of deformable bodies. `scene` must outlive this.
    BroadSweep(const Scene& scene, const Geometry& geometry, Broad bound);

    /// Pairs in ascending order. O(n log n) and the pairs that overlap along the sweep.
    std::vector<BodyPair> pairs(const Frame& frame) const { return pairs(frame, {}); }
    /// Those that may overlap as long as no vertex is further from where `frame` has it than its body's
    /// margin; none: 0.
    std::vector<BodyPair> pairs(const Frame& frame, std::span<const double> margins) const;
    /// Those of bodies that fill these balls.
    std::vector<BodyPair> pairs(std::span<const Ball> balls) const;

    /// Bounds of one body: lower and upper end along each axis, one after the other.
    void bound(const Frame& frame, std::uint32_t body, double margin, double* slabs) const;
    std::size_t axes() const { return directions_.size(); }

private:
    struct Shape {
        Eigen::Vector3d centre, half;
        double radius = 0; ///< of the sphere around `centre`
        double reach = 0;  ///< largest distance of a vertex from the mesh's origin
    };

    std::vector<BodyPair> swept(const std::vector<double>& slabs) const;
    Shape shape_of(const std::vector<Eigen::Vector3d>& vertices) const;
    void bound_rigid(const Shape& shape, const Pose& pose, double* slabs) const;
    void bound_deformed(const std::vector<Eigen::Vector3d>& vertices, double* slabs) const;
    void widen(double* slabs, double margin) const;
    std::size_t sweep_direction(const std::vector<double>& slabs) const;

    const Scene& scene_;
    std::vector<Eigen::Vector3d> directions_;
    Broad bound_;
    double roundoff_;
    double underflow_;          ///< that a coordinate may have lost
    double tolerance_;          ///< of the overlap test along unit directions
    std::vector<Shape> shapes_; ///< by mesh
};

} // namespace tandem
