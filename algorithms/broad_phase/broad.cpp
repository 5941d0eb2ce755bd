// SPDX-License-Identifier: MIT
#include "algorithms/broad_phase/broad.h"

#include "algorithms/bodies/arc.h"
#include "algorithms/bodies/ball.h"
#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/self_pairs.h"
#include "algorithms/bodies/shift.h"
#include "algorithms/broad_phase/slab_sweep.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tandem {

namespace {

/// Number of roundings between a body's vertex and a slab: input, rotation (4), two sums, and E of a safe
/// corner (4). It is doubled for safety and for the bound of drift (6; placement=exact). underflow() bounds
/// the additional error below the least normal number.
constexpr double rounding_steps = 24;

/// Widening for published rounding, whose tolerance applies to unit directions. Each of two bodies gets half
/// of it; the factor 3 covers the roundings of the test.
constexpr double published_slack = 3 * 0.5 * 10 * 0x1p-23;

} // namespace

BroadSweep::BroadSweep(const Scene& scene, const Geometry& geometry, Broad bound, SelfPairs self)
    : scene_(scene),
      bound_(bound),
      roundoff_(std::ldexp(1.0, geometry.precision == Precision::fp64 ? -53 : -24)),
      underflow_(underflow(geometry.precision)),
      margin_(double{reach_of_margin(geometry)} * (1 + 0x1p-16)),
      tolerance_(geometry.rounding == Rounding::published ? published_slack : 0) {
    if (bound == Broad::sphere_boxes)
        directions_ = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()};
    else
        for (const auto& d : directions(geometry)) directions_.emplace_back(d[0], d[1], d[2]);
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh)
        shapes_.push_back(shape_of(scene.meshes[mesh].vertices, shift_in(scene, mesh)));
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        if (meets_itself(scene, body, self)) own_.push_back({body, body});
}

BroadSweep::Shape BroadSweep::shape_of(const std::vector<Eigen::Vector3d>& vertices,
                                       const Eigen::Vector3d& shift) const {
    const auto ball = ball_around(vertices);
    Shape shape{ball.centre, Eigen::Vector3d::Zero(), ball.radius, reach_of(vertices),
                reach_of(vertices, shift)};
    for (const auto& v : vertices) shape.half = shape.half.cwiseMax((v - shape.centre).cwiseAbs());
    return shape;
}

void BroadSweep::bound_rigid(const Shape& shape, const Pose& pose, double* slabs) const {
    const Eigen::Matrix3d rotation = pose.rotation.normalized().toRotationMatrix();
    const Eigen::Vector3d centre = rotation * shape.centre + pose.translation;
    const double slack =
        rounding_steps * roundoff_ * (pose.translation.lpNorm<1>() + 2 * shape.reach) + underflow_;
    for (const auto& d : directions_) {
        const double reach = bound_ == Broad::tight ? (rotation.transpose() * d).cwiseAbs().dot(shape.half)
                                                    : shape.radius * d.norm();
        const double middle = d.dot(centre);
        const double width = reach * (1 + 8 * std::numeric_limits<double>::epsilon()) + slack * d.lpNorm<1>()
                             + tolerance_ * d.norm();
        *slabs++ = middle - width;
        *slabs++ = middle + width;
    }
}

void BroadSweep::bound_deformed(const std::vector<Eigen::Vector3d>& vertices, double* slabs) const {
    const auto shape = shape_of(vertices);
    for (const auto& d : directions_) {
        double lower = d.dot(shape.centre) - shape.radius * d.norm();
        double upper = d.dot(shape.centre) + shape.radius * d.norm();
        if (bound_ == Broad::tight) {
            lower = std::numeric_limits<double>::infinity();
            upper = -lower;
            for (const auto& v : vertices) {
                lower = std::min(lower, d.dot(v));
                upper = std::max(upper, d.dot(v));
            }
        }
        const double slack = (rounding_steps * roundoff_ * 2 * shape.reach + underflow_) * d.lpNorm<1>()
                             + tolerance_ * d.norm();
        *slabs++ = lower - slack;
        *slabs++ = upper + slack;
    }
}

/// A point displaced by `skin` is displaced by at most that along a unit direction.
void BroadSweep::widen(double* slabs, double skin) const {
    for (const auto& d : directions_) {
        const double width = skin * d.norm() * (1 + 8 * std::numeric_limits<double>::epsilon());
        *slabs++ -= width;
        *slabs++ += width;
    }
}

std::size_t BroadSweep::sweep_direction(std::span<const double> slabs) const {
    const auto stride = 2 * directions_.size();
    const auto bodies = slabs.size() / stride;
    std::size_t best = 0;
    double most = -1;
    for (std::size_t axis = 0; axis < directions_.size(); ++axis) {
        double sum = 0;
        double squares = 0;
        for (std::size_t body = 0; body < bodies; ++body) {
            const double middle = slabs[body * stride + 2 * axis] / directions_[axis].norm();
            sum += middle;
            squares += middle * middle;
        }
        const double spread = squares - sum * sum / static_cast<double>(bodies);
        if (spread > most) {
            most = spread;
            best = axis;
        }
    }
    return best;
}

void BroadSweep::bound_in(const Frame& frame, std::uint32_t body, double skin, double* slabs) const {
    if (scene_.bodies[body].deformable)
        bound_deformed(frame.deformed[body], slabs);
    else
        bound_rigid(shapes_[scene_.bodies[body].mesh], frame.poses[body], slabs);
    if (skin + margin_ > 0) widen(slabs, skin + margin_);
}

/// Extends the bounds of a body in a frame by those in its successor and by the path between them.
void BroadSweep::add_path(const FrameInput& input, std::uint32_t body, double skin, double* slabs) const {
    std::vector<double> next(2 * directions_.size());
    bound_in(*input.next, body, skin, next.data());
    for (std::size_t i = 0; i < next.size(); i += 2) {
        slabs[i] = std::min(slabs[i], next[i]);
        slabs[i + 1] = std::max(slabs[i + 1], next[i + 1]);
    }
    if (scene_.bodies[body].deformable) return;
    // The factor covers that kernels compute with rounded distances, arcs and lengths of directions.
    constexpr double slack = 1 + 0x1p-16;
    const double arc = arc_between(input.frame.poses[body], input.next->poses[body]);
    if (arc > 0) widen(slabs, arc * shapes_[scene_.bodies[body].mesh].arm * slack + underflow_);
}

void BroadSweep::bound(const FrameInput& input, std::uint32_t body, double skin, double* slabs) const {
    bound_in(input.frame, body, skin, slabs);
    if (input.next != nullptr) add_path(input, body, skin, slabs);
}

std::vector<BodyPair> BroadSweep::pairs(const FrameInput& input, std::span<const double> skins) const {
    const auto stride = 2 * directions_.size();
    std::vector<double> slabs(scene_.bodies.size() * stride);
    constexpr std::size_t part = 1024;
    const auto bodies = scene_.bodies.size();
    parallel_for((bodies + part - 1) / part, [&](std::size_t i) {
        for (auto body = i * part; body < std::min(bodies, (i + 1) * part); ++body)
            bound(input, static_cast<std::uint32_t>(body), skins.empty() ? 0 : skins[body],
                  &slabs[body * stride]);
    });
    return swept(slabs);
}

/// Each world by itself, on all cores.
std::vector<BodyPair> BroadSweep::swept_by_world(const std::vector<double>& slabs) const {
    std::vector<std::uint32_t> firsts; // bodies with which worlds begin
    const auto bodies = static_cast<std::uint32_t>(scene_.bodies.size());
    for (std::uint32_t body = 0; body < bodies; ++body)
        if (body == 0 || world_of(scene_, body) != world_of(scene_, body - 1)) firsts.push_back(body);
    firsts.push_back(bodies);
    std::vector<std::vector<BodyPair>> found(firsts.size() - 1);
    const auto stride = 2 * directions_.size();
    parallel_for(found.size(), [&](std::size_t world) {
        const auto first = firsts[world];
        const auto own = std::span(slabs).subspan(first * stride, (firsts[world + 1] - first) * stride);
        found[world] = overlapping(own, directions_.size(), sweep_direction(own));
        for (auto& pair : found[world]) pair = {pair.a + first, pair.b + first};
    });
    std::vector<BodyPair> all;
    for (const auto& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
    return all;
}

std::vector<BodyPair> BroadSweep::pairs(std::span<const Ball> balls) const {
    std::vector<double> slabs;
    for (const auto& ball : balls)
        for (const auto& d : directions_) {
            const double width = (ball.radius + margin_) * d.norm();
            slabs.push_back(d.dot(ball.centre) - width);
            slabs.push_back(d.dot(ball.centre) + width);
        }
    return swept(slabs);
}

/// The pairs of bodies whose slabs overlap along all directions, and those of bodies with themselves.
std::vector<BodyPair> BroadSweep::swept(const std::vector<double>& slabs) const {
    auto pairs = scene_.world_size != 0 ? swept_by_world(slabs)
                                        : overlapping(slabs, directions_.size(), sweep_direction(slabs));
    std::erase_if(pairs, [this](BodyPair pair) { return !may_meet(scene_, pair.a, pair.b); });
    const auto of_two = static_cast<std::ptrdiff_t>(pairs.size());
    pairs.insert(pairs.end(), own_.begin(), own_.end());
    std::inplace_merge(pairs.begin(), pairs.begin() + of_two, pairs.end());
    return pairs;
}

} // namespace tandem
