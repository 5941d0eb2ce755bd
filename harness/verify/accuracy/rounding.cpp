// SPDX-License-Identifier: MIT
#include "harness/verify/accuracy/rounding.h"

#include "geometry/contact_truth.h"
#include "harness/verify/oracle/posed.h"
#include "harness/verify/world_vertices.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tandem {

namespace {

using oracle::Points;
using oracle::Vector;

/// A vertex of the input.
Vector<mpq_class> input_point(const Scene& scene, const Frame& input, std::uint32_t body,
                              std::uint32_t vertex) {
    const auto is_deformable = scene.bodies[body].deformable;
    const auto& v =
        is_deformable ? input.deformed[body][vertex] : scene.meshes[scene.bodies[body].mesh].vertices[vertex];
    if (!is_deformable) return oracle::posed_point(input.poses[body], {v.x(), v.y(), v.z()});
    return {mpq_class(v.x()), mpq_class(v.y()), mpq_class(v.z())};
}

template<class Real>
bool rounds_body(const RoundedFrame& frame, std::uint32_t body) {
    const auto vertices = world_vertices<Real>(frame.scene, *frame.cell, body, frame.positions.origin);
    for (std::uint32_t i = 0; i < vertices.size(); ++i) {
        const bool is_finite = std::ranges::all_of(vertices[i], [](Real x) { return std::isfinite(x); });
        if (!is_finite) continue; // its tetrahedra are in no pair
        const auto exact = input_point(frame.scene, *frame.input, body, i);
        for (unsigned axis = 0; axis < 3; ++axis)
            if (mpq_class(static_cast<double>(vertices[i][axis])) + mpq_class(frame.origin[axis])
                != exact[axis])
                return true;
    }
    return false;
}

/// Number of pairs of an ascending list that do not meet by a truth.
std::uint64_t apart_in(std::span<const Pair> pairs, const FrameTruth& truth) {
    if (pairs.empty()) return 0;
    PairCursor touching(truth.touching, pairs.front()), overlapping(truth.overlapping, pairs.front());
    return static_cast<std::uint64_t>(std::ranges::count_if(
        pairs, [&](const Pair& pair) { return !touching.contains(pair) && !overlapping.contains(pair); }));
}

/// The corners of the input relative to the first one of tetrahedron a, each coordinate rounded once. A depth
/// does not depend on where a pair is.
std::array<TetraCorners, 2> input_corners(const Scene& scene, const Frame& input, const Pair& pair) {
    std::array<Points<mpq_class>, 2> exact;
    for (unsigned side = 0; side < 2; ++side) {
        const auto body = side == 0 ? pair.body_a : pair.body_b;
        const auto tetrahedron = side == 0 ? pair.tet_a : pair.tet_b;
        const auto& corners = scene.meshes[scene.bodies[body].mesh].tetrahedra[tetrahedron];
        for (unsigned i = 0; i < 4; ++i) exact[side][i] = input_point(scene, input, body, corners[i]);
    }
    std::array<TetraCorners, 2> result;
    for (unsigned side = 0; side < 2; ++side)
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned axis = 0; axis < 3; ++axis) {
                const mpq_class difference = exact[side][i][axis] - exact[0][0][axis];
                result[side][i][axis] = difference.get_d();
            }
    return result;
}

/// At most `most` pairs that overlap by either truth; 0: all.
std::vector<Pair> overlapping_pairs(const FrameTruth& cell, const FrameTruth& input, std::size_t most) {
    std::vector<Pair> all, chosen;
    std::ranges::set_union(cell.overlapping, input.overlapping, std::back_inserter(all));
    const auto count = most == 0 ? all.size() : std::min(most, all.size());
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(all[i * all.size() / count]);
    return chosen;
}

} // namespace

void RoundingErrors::add(const RoundingErrors& other) {
    meeting += other.meeting;
    lost += other.lost;
    extra += other.extra;
    missed += other.missed;
    if (other.depth_change) depth_change = std::max(depth_change.value_or(0), *other.depth_change);
}

bool rounds(const RoundedFrame& frame) {
    for (std::uint32_t body = 0; body < frame.scene.bodies.size(); ++body)
        if (frame.positions.precision == Precision::fp64 ? rounds_body<double>(frame, body)
                                                         : rounds_body<float>(frame, body))
            return true;
    return false;
}

RoundingErrors rounding_errors(const FrameTruth& cell, const FrameTruth& input) {
    RoundingErrors errors;
    errors.meeting = input.touching.size() + input.overlapping.size();
    errors.lost = apart_in(input.touching, cell) + apart_in(input.overlapping, cell);
    errors.extra = apart_in(cell.touching, input) + apart_in(cell.overlapping, input);
    return errors;
}

double depth_change(const RoundedFrame& frame, const FrameTruth& cell, const FrameTruth& input,
                    std::size_t most) {
    const auto pairs = overlapping_pairs(cell, input, most);
    const auto rounded = pair_corners(frame.scene, *frame.cell, frame.positions, pairs);
    std::vector<double> changes(pairs.size());
    parallel_for(pairs.size(), [&](std::size_t i) {
        const auto exact = input_corners(frame.scene, *frame.input, pairs[i]);
        const auto before = contact_truth(exact[0], exact[1]);
        const auto after = contact_truth(rounded[i][0], rounded[i][1]);
        // A tetrahedron of no volume overlaps nothing.
        changes[i] = std::abs((after ? after->depth : 0) - (before ? before->depth : 0));
    });
    return changes.empty() ? 0 : std::ranges::max(changes);
}

} // namespace tandem
