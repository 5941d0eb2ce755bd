// SPDX-License-Identifier: MIT
#include "harness/oracle/frame_truth.h"

#include "harness/oracle/superset.h"
#include "scenes/parallel.h"
#include "harness/world_vertices.h"

#include <algorithm>

namespace tandem {

namespace {

using namespace oracle;

/// Corners of all tetrahedra of every body.
using World = std::vector<std::vector<TetraCorners>>;

template<class Real>
World world_in(const Scene& scene, const Frame& frame) {
    World world(scene.bodies.size());
    parallel_for(world.size(), [&](std::size_t body) {
        const auto vertices = world_vertices<Real>(scene, frame, body);
        for (const auto& tetrahedron : scene.meshes[scene.bodies[body].mesh].tetrahedra) {
            auto& corners = world[body].emplace_back();
            for (unsigned i = 0; i < 4; ++i)
                for (unsigned axis = 0; axis < 3; ++axis)
                    corners[i][axis] = static_cast<double>(vertices[tetrahedron[i]][axis]);
        }
    });
    return world;
}

World world_of(const Scene& scene, const Frame& frame, Precision precision) {
    return precision == Precision::twice ? world_in<double>(scene, frame) : world_in<float>(scene, frame);
}

std::vector<Decision> decide_all(const World& world, std::span<const Pair> pairs) {
    std::vector<Decision> result(pairs.size());
    constexpr std::size_t part = 1024;
    parallel_for((pairs.size() + part - 1) / part, [&](std::size_t index) {
        const auto end = std::min(pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i)
            result[i] =
                decide(world[pairs[i].body_a][pairs[i].tet_a], world[pairs[i].body_b][pairs[i].tet_b]);
    });
    return result;
}

/// Pairs of bodies, not both fixed, whose boxes meet.
std::vector<std::array<std::uint32_t, 2>> near_bodies(const Scene& scene, const std::vector<Boxes>& boxes) {
    std::vector<std::array<std::uint32_t, 2>> result;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
            if (!(scene.bodies[a].fixed && scene.bodies[b].fixed)
                && boxes_meet(boxes[a].whole, boxes[b].whole))
                result.push_back({a, b});
    return result;
}

/// Decides pairs in blocks and keeps those that meet.
void keep_meeting(const World& world, std::span<const Pair> pairs, FrameTruth& truth,
                  const std::function<void(std::size_t)>& after) {
    constexpr std::size_t block = 1 << 18;
    for (std::size_t first = 0; first < pairs.size(); first += block) {
        const auto part = pairs.subspan(first, std::min(block, pairs.size() - first));
        const auto decisions = decide_all(world, part);
        for (std::size_t i = 0; i < part.size(); ++i) {
            truth.decisions.add(decisions[i]);
            if (decisions[i].relation == Relation::touching) truth.touching.push_back(part[i]);
            if (decisions[i].relation == Relation::overlapping) truth.overlapping.push_back(part[i]);
        }
        after(first + part.size());
    }
}

/// Pairs of tetrahedra near each other, of some pairs of bodies.
std::vector<Pair> near_pairs(const std::vector<Boxes>& boxes,
                             std::span<const std::array<std::uint32_t, 2>> bodies) {
    std::vector<std::vector<Pair>> found(bodies.size());
    parallel_for(bodies.size(), [&](std::size_t i) {
        const auto [a, b] = bodies[i];
        add_near_pairs(boxes[a], boxes[b], a, b, found[i]);
    });
    std::vector<Pair> result;
    for (const auto& part : found) result.insert(result.end(), part.begin(), part.end());
    return result;
}

bool holds(std::span<const Pair> sorted, const Pair& pair) {
    return std::binary_search(sorted.begin(), sorted.end(), pair);
}

} // namespace

FrameTruth frame_truth(const Scene& scene, const Frame& frame, Precision precision, const Report& report) {
    FrameTruth truth;
    const auto world = world_of(scene, frame, precision);
    std::vector<Boxes> boxes(world.size());
    parallel_for(world.size(), [&](std::size_t body) {
        boxes[body] = frame.skipped.empty() ? Boxes(world[body]) : Boxes(world[body], frame.skipped[body]);
    });
    for (std::uint32_t body = 0; body < boxes.size(); ++body)
        for (const auto tetrahedron : boxes[body].invalid) truth.invalid.push_back({body, tetrahedron});
    const auto bodies = near_bodies(scene, boxes);
    constexpr std::size_t round =
        256; // pairs of bodies at a time, so that not all their pairs are kept at once
    std::uint64_t decided = 0;
    for (std::size_t first = 0; first < bodies.size(); first += round) {
        const auto count = std::min(round, bodies.size() - first);
        const auto pairs = near_pairs(boxes, std::span(bodies).subspan(first, count));
        keep_meeting(world, pairs, truth, [&](std::size_t done) {
            const auto share = static_cast<double>(done) / static_cast<double>(pairs.size());
            const auto past = static_cast<double>(first) + share * static_cast<double>(count);
            if (report) report(past / static_cast<double>(bodies.size()), decided + done);
        });
        decided += pairs.size();
    }
    std::sort(truth.touching.begin(), truth.touching.end());
    std::sort(truth.overlapping.begin(), truth.overlapping.end());
    return truth;
}

std::vector<Decision> decide_pairs(const Scene& scene, const Frame& frame, Precision precision,
                                   std::span<const Pair> pairs) {
    return decide_all(world_of(scene, frame, precision), pairs);
}

std::vector<std::array<TetraCorners, 2>> pair_corners(const Scene& scene, const Frame& frame,
                                                      Precision precision, std::span<const Pair> pairs) {
    std::vector<std::array<TetraCorners, 2>> corners;
    if (pairs.empty()) return corners;
    const auto world = world_of(scene, frame, precision);
    for (const auto& pair : pairs)
        corners.push_back({world[pair.body_a][pair.tet_a], world[pair.body_b][pair.tet_b]});
    return corners;
}

PairErrors pair_errors(const FrameTruth& truth, std::span<const Pair> candidates) {
    PairErrors errors;
    errors.candidates = candidates.size();
    const auto invalid = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        return std::binary_search(truth.invalid.begin(), truth.invalid.end(), std::array{body, tetrahedron});
    };
    for (const auto& pair : candidates) {
        if (holds(truth.touching, pair))
            ++errors.touching;
        else if (holds(truth.overlapping, pair))
            ++errors.overlapping;
        else if (invalid(pair.body_a, pair.tet_a) || invalid(pair.body_b, pair.tet_b))
            ++errors.invalid;
        else
            ++errors.disjoint;
    }
    errors.missed_touching = truth.touching.size() - errors.touching;
    errors.missed_overlapping = truth.overlapping.size() - errors.overlapping;
    return errors;
}

} // namespace tandem
