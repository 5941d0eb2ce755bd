// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/ball.h"
#include "scenes/scene.h"

#include <span>

namespace tandem {

// How skins grow, in partitions and for ghost bodies alike.
constexpr double largest_skin = 2; ///< fraction of a radius: larger ones bring nearly all bodies of a heap
constexpr std::size_t short_lived = 8; ///< frames: what expires sooner costs more than a larger skin does

/// Where bodies were in some frame, and how far they have gone since.
class DisplacementTracker {
public:
    /// `scene` must outlive this.
    explicit DisplacementTracker(const Scene& scene);

    /// From now on ways are from where `frame` has these bodies. O(vertices) of deformable ones.
    void set_reference(const Frame& frame, std::span<const std::uint32_t> bodies);
    /// Where a body of that frame was: every vertex of it is in there.
    const Ball& ball(std::uint32_t body) const { return balls_[body]; }
    /// No vertex of the body is further from where it was kept. Not a number where a coordinate is none.
    double displacement(const Frame& frame, std::uint32_t body) const;
    /// Whether none of these, fixed ones aside, has gone further than `margin` of its ball's radius.
    bool all_within(const Frame& frame, std::span<const std::uint32_t> bodies, double skin) const;
    /// Margins of all bodies: that share of their radii.
    std::vector<double> skins(double fraction) const;

private:
    const Scene& scene_;
    std::vector<Ball> mesh_balls_; ///< in the frame of each mesh
    std::vector<Ball> balls_;      ///< by body
    Frame reference_;
};

} // namespace tandem
