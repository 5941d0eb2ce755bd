// SPDX-License-Identifier: MIT
// Bounds of the reference: leaf k-DOPs by independent code with the cell's own arithmetic.
#pragma once

#include "algorithms/bodies/arc.h"
#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/frame_input.h"
#include "algorithms/bounds/geometry.h"
#include "harness/verify/oracle/drift.h"
#include "harness/verify/world_vertices.h"

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

namespace tandem::reference_bounds {

/// Slabs of a body's tetrahedra, `stride` reals each: lower bounds, then upper bounds.
template<class Real>
struct Bounds {
    std::size_t axes = 0;
    bool published = false; ///< whether Rounding::published applies
    std::vector<std::array<Real, 3>> vertices;
    std::vector<Real> slabs;
    std::vector<Real> whole; ///< of the body

    const Real* tetrahedron(std::size_t i) const { return &slabs[i * 2 * axes]; }
};

/// Whether a slab starts after another's end; in the paper's test, by more than its tolerance.
template<class Real>
bool apart(Real lower, Real upper, bool published) {
    constexpr Real tolerance = 10 * std::numeric_limits<float>::epsilon();
    return published ? lower - upper > tolerance : lower > upper;
}

/// Closed test: touching slabs overlap.
template<class Real>
bool overlapping(const Real* a, const Real* b, std::size_t axes, bool published) {
    for (std::size_t axis = 0; axis < axes; ++axis)
        if (apart(a[axis], b[axes + axis], published) || apart(b[axis], a[axes + axis], published))
            return false;
    return true;
}

/// Sum of the terms in order, rounded to nearest. `partial` is the sum of the magnitudes of all partial sums;
/// a single term counts as one.
template<class Real>
Real nearest_sum(std::span<const Real> terms, Real& partial) {
    Real sum = terms[0];
    partial = terms.size() == 1 ? std::fabs(sum) : 0;
    for (const auto term : terms.subspan(1)) {
        sum += term;
        partial += std::fabs(sum);
    }
    return sum;
}

/// Sum of the terms in order, with every addition rounded in a mode of fesetround. volatile stops the
/// compiler from moving additions across fesetround, which it treats as an ordinary call.
template<class Real>
Real directed_sum(std::span<const Real> terms, int mode) {
    volatile Real sum = terms[0];
    std::fesetround(mode);
    for (const auto term : terms.subspan(1)) {
        const volatile Real next = term;
        sum = sum + next;
    }
    std::fesetround(FE_TONEAREST);
    return sum;
}

/// The length of a direction with that many non-zeros, rounded up.
template<class Real>
Real length_of(std::size_t count) {
    constexpr bool is_double = std::is_same_v<Real, double>;
    constexpr Real edge = is_double ? Real(1.4142135623730952) : Real(1.41421366);
    constexpr Real corner = is_double ? Real(1.7320508075688775) : Real(1.73205090);
    return count == 1 ? Real(1) : count == 2 ? edge : corner;
}

/// Lower and upper bound of a point's projection for a rounding (algorithms/bounds/README.md). `drift` bounds
/// the point's error along each axis; null for Placement::rounded. `reach`: the
/// radius of the ball of points around it.
template<class Real>
std::pair<Real, Real> project(const std::array<Real, 3>& point, const std::array<int, 3>& direction,
                              Rounding rounding, const std::array<Real, 3>* drift, Real reach) {
    std::array<Real, 3> terms{};
    std::size_t count = 0;
    Real off = 0;
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) continue;
        terms[count++] = direction[i] > 0 ? point[i] : -point[i];
        if (drift != nullptr) off += (*drift)[i];
    }
    off += reach * length_of<Real>(count);
    // The paper's release divides by the direction's length, sqrt(2) or sqrt(3), with these constants.
    if (rounding == Rounding::published && count > 1)
        for (auto& term : terms)
            term *=
                count == 2 ? static_cast<Real>(0.7071067811865476) : static_cast<Real>(0.5773502691896258);
    const auto used = std::span<const Real>(terms).first(count);
    if (rounding == Rounding::directed) {
        const std::array<Real, 2> low{directed_sum(used, FE_DOWNWARD), -off};
        const std::array<Real, 2> high{directed_sum(used, FE_UPWARD), off};
        return {directed_sum(std::span<const Real>(low), FE_DOWNWARD),
                directed_sum(std::span<const Real>(high), FE_UPWARD)};
    }
    Real partial = 0;
    const Real sum = nearest_sum(used, partial);
    Real bound = 0;
    if (drift != nullptr || off > 0 || (rounding == Rounding::safe && count == 3))
        bound = partial * (2 * std::numeric_limits<Real>::epsilon()) + off;
    return {sum - bound, sum + bound};
}

/// The bound on a body's drift is an input here, not recomputed independently; a separate test compares it
/// with the exact truth.
template<class Real>
std::array<Real, 3> drift_in(const Scene& scene, const Frame& frame, const Geometry& geometry,
                             std::size_t body) {
    const auto bound = scene.bodies[body].deformable
                           ? drift_bound(frame.deformed[body], geometry.precision)
                           : drift_bound_of(scene, frame, body, geometry.precision, geometry.origin);
    return {static_cast<Real>(bound[0]), static_cast<Real>(bound[1]), static_cast<Real>(bound[2])};
}

/// Bounds on the distances of a body's vertices from the straight paths to the next frame. The arc is an
/// input here, as drift is. Empty for straight paths.
template<class Real>
std::vector<Real> swings_of(const Scene& scene, const FrameInput& input, Origin origin, std::size_t body) {
    std::vector<Real> swings;
    if (input.next == nullptr || scene.bodies[body].deformable) return swings;
    const auto arc = static_cast<Real>(arc_between(input.frame.poses[body], input.next->poses[body]));
    if (!(arc > 0)) return swings;
    const auto& mesh = scene.meshes[scene.bodies[body].mesh];
    const auto centre = centre_of(mesh, origin);
    for (const auto& v : mesh.vertices) {
        // The body turns about its mesh's own origin, from which rounding has moved the vertex by an ulp of
        // its distance from the centre.
        const auto x = static_cast<double>(static_cast<Real>(v.x() - centre[0])) + centre[0];
        const auto y = static_cast<double>(static_cast<Real>(v.y() - centre[1])) + centre[1];
        const auto z = static_cast<double>(static_cast<Real>(v.z() - centre[2])) + centre[2];
        const auto distance = static_cast<Real>(std::hypot(x, y, z) * (1 + 0x1p-20));
        swings.push_back(distance > 0 ? distance * arc + std::numeric_limits<Real>::min() : 0);
    }
    return swings;
}

/// The pressures of a mesh's vertices as devices have them; -1 without a field.
template<class Real>
std::vector<Real> pressures_of(const Mesh& mesh) {
    std::vector<Real> result(mesh.vertices.size(), Real(-1));
    std::ranges::transform(mesh.pressures, result.begin(), [](double p) { return static_cast<Real>(p); });
    return result;
}

/// Slabs of all tetrahedra of one body, each computed separately from its own vertices. `swings`: of the
/// vertices on the path to the next frame; empty: 0. With a margin, each vertex stands for a ball, whose
/// radius is an input here, as drift is.
template<class Real>
Bounds<Real> bounds_of(const Scene& scene, const Frame& frame, const Geometry& geometry, std::size_t body,
                       std::span<const Real> swings) {
    const auto axes = directions(geometry);
    Bounds<Real> bounds;
    bounds.axes = axes.size() + (geometry.pressure_slab ? 1 : 0); // the last one of pressures
    bounds.published = geometry.rounding == Rounding::published;
    const bool drifts = geometry.placement == Placement::exact;
    const auto drift = drifts ? drift_in<Real>(scene, frame, geometry, body) : std::array<Real, 3>{};
    const auto margin = static_cast<Real>(reach_of_margin(geometry));
    bounds.vertices = world_vertices<Real>(scene, frame, body, geometry.origin);
    const auto& tetrahedra = scene.meshes[scene.bodies[body].mesh].tetrahedra;
    bounds.slabs.resize(tetrahedra.size() * 2 * bounds.axes);
    bounds.whole.assign(bounds.axes, std::numeric_limits<Real>::infinity());
    bounds.whole.insert(bounds.whole.end(), bounds.axes, -std::numeric_limits<Real>::infinity());
    std::vector<bool> skipped(tetrahedra.size());
    for (const auto t : skipped_in(scene, frame, body)) skipped[t] = true;
    const auto pressures = pressures_of<Real>(scene.meshes[scene.bodies[body].mesh]);
    const auto span_of = [&](std::size_t vertex, std::size_t axis) {
        if (axis == axes.size()) return std::pair(pressures[vertex], pressures[vertex]);
        return project(bounds.vertices[vertex], axes[axis], geometry.rounding, drifts ? &drift : nullptr,
                       swings.empty() ? margin : swings[vertex] + margin);
    };
    for (std::size_t axis = 0; axis < bounds.axes; ++axis) {
        for (std::size_t t = 0; t < tetrahedra.size(); ++t) {
            Real lower = std::numeric_limits<Real>::infinity();
            Real upper = -lower;
            for (const auto vertex : tetrahedra[t]) {
                if (skipped[t]) break; // an empty slab overlaps nothing
                const auto [low, high] = span_of(vertex, axis);
                lower = std::min(lower, low);
                upper = std::max(upper, high);
            }
            bounds.slabs[t * 2 * bounds.axes + axis] = lower;
            bounds.slabs[t * 2 * bounds.axes + bounds.axes + axis] = upper;
            bounds.whole[axis] = std::min(bounds.whole[axis], lower);
            bounds.whole[bounds.axes + axis] = std::max(bounds.whole[bounds.axes + axis], upper);
        }
    }
    return bounds;
}

/// The same for the frame and, if the input has one, its successor. The vertices are those of the frame.
template<class Real>
Bounds<Real> bounds_of(const Scene& scene, const FrameInput& input, const Geometry& geometry,
                       std::size_t body) {
    const auto swings = swings_of<Real>(scene, input, geometry.origin, body);
    auto bounds = bounds_of<Real>(scene, input.frame, geometry, body, swings);
    if (input.next == nullptr) return bounds;
    const auto next = bounds_of<Real>(scene, *input.next, geometry, body, swings);
    const auto merge = [&](std::vector<Real>& all, const std::vector<Real>& more) {
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] =
                i % (2 * bounds.axes) < bounds.axes ? std::min(all[i], more[i]) : std::max(all[i], more[i]);
    };
    merge(bounds.slabs, next.slabs);
    merge(bounds.whole, next.whole);
    return bounds;
}

} // namespace tandem::reference_bounds
