// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/ball.h"
#include "algorithms/bodies/frame_input.h"
#include "scenes/scene.h"

#include <span>

namespace tandem {

// Limits for the growth of skins, for partitions and ghost bodies.
constexpr double largest_skin = 2; ///< fraction of a radius; beyond it nearly all bodies of a heap are ghosts
constexpr std::size_t min_lifetime = 8; ///< frames; earlier expiry costs more than a larger skin

/// Positions of bodies in a reference frame, and their displacements since that frame.
class DisplacementTracker {
public:
    /// `scene` must outlive this.
    explicit DisplacementTracker(const Scene& scene);

    /// Makes `frame` the reference of these bodies. O(vertices) for deformable bodies.
    void set_reference(const Frame& frame, std::span<const std::uint32_t> bodies);
    /// A ball that contains all vertices of the body in the reference frame.
    const Ball& ball(std::uint32_t body) const { return balls_[body]; }
    /// Upper bound on the displacement of every vertex since the reference frame. NaN if a coordinate is NaN.
    double displacement(const Frame& frame, std::uint32_t body) const;
    /// Whether every body of these that is not fixed is displaced by at most `skin` times the radius of its
    /// ball, in the frame and on the path to its successor.
    bool all_within(const FrameInput& input, std::span<const std::uint32_t> bodies, double skin) const;
    /// Skins of all bodies: `fraction` of the radii of their balls.
    std::vector<double> skins(double fraction) const;

private:
    double displacement_on_path(const FrameInput& input, std::uint32_t body) const;

    const Scene& scene_;
    std::vector<Ball> mesh_balls_;   ///< by mesh, in mesh coordinates
    std::vector<double> mesh_reach_; ///< by mesh: distance from the origin about which it turns
    std::vector<Ball> balls_;        ///< by body
    Frame reference_;
};

} // namespace tandem
