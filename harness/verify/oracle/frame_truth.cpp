// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/frame_truth.h"

#include "algorithms/bodies/drift.h"
#include "harness/verify/oracle/near_pairs.h"
#include "harness/verify/oracle/posed.h"
#include "harness/verify/oracle/world.h"
#include "base/parallel.h"

#include <algorithm>

namespace tandem {

namespace {

using namespace oracle;

/// The input of the decision.
class PosedBodies {
public:
    PosedBodies(const Scene& scene, const Frame& frame, Positions positions)
        : scene_(scene),
          frame_(frame),
          world_(world_of(scene, frame, positions.precision, positions.origin)),
          off_(world_.size()),
          posed_(positions.placement == Placement::exact) {
        if (!posed_) return;
        parallel_for(world_.size(), [&](std::size_t body) {
            if (is_rigid(body))
                off_[body] = std::ranges::max(
                    drift_bound(frame.poses[body], reach_of(mesh(body).vertices), positions.precision));
        });
    }

    std::size_t count() const { return world_.size(); }
    Boxes boxes(std::size_t body) const {
        return Boxes(world_[body], skipped_in(scene_, frame_, body), off_[body]);
    }
    Decision decided(const Pair& pair) const {
        if (posed_) return decide(posed(pair.body_a, pair.tet_a), posed(pair.body_b, pair.tet_b));
        return decide(world_[pair.body_a][pair.tet_a], world_[pair.body_b][pair.tet_b]);
    }

private:
    bool is_rigid(std::size_t body) const { return !scene_.bodies[body].deformable; }
    const Mesh& mesh(std::size_t body) const { return scene_.meshes[scene_.bodies[body].mesh]; }

    Posed posed(std::uint32_t body, std::uint32_t tetrahedron) const {
        Posed result{world_[body][tetrahedron], off_[body], {}, nullptr};
        result.own = result.near; // a deformable body's vertices in the frame are world vertices in double
        if (!is_rigid(body)) return result;
        result.pose = &frame_.poses[body];
        for (unsigned i = 0; i < 4; ++i) {
            const auto& v = mesh(body).vertices[mesh(body).tetrahedra[tetrahedron][i]];
            result.own[i] = {v.x(), v.y(), v.z()};
        }
        return result;
    }

    const Scene& scene_;
    const Frame& frame_;
    World world_;
    std::vector<double> off_; ///< by body: error bound of its coordinates in `world_`
    bool posed_;
};

std::vector<Decision> decide_all(const PosedBodies& bodies, std::span<const Pair> pairs) {
    std::vector<Decision> result(pairs.size());
    constexpr std::size_t part = 1024;
    parallel_for((pairs.size() + part - 1) / part, [&](std::size_t index) {
        const auto end = std::min(pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i) result[i] = bodies.decided(pairs[i]);
    });
    return result;
}

/// Decides pairs and stores those that intersect.
void add_intersecting(const PosedBodies& bodies, std::span<const Pair> pairs, FrameTruth& truth) {
    const auto decisions = decide_all(bodies, pairs);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        truth.decisions.add(decisions[i]);
        if (decisions[i].relation == Relation::touching) truth.touching.push_back(pairs[i]);
        if (decisions[i].relation == Relation::overlapping) truth.overlapping.push_back(pairs[i]);
    }
}

/// `candidates` must be ascending.
PairErrors errors_of(const FrameTruth& truth, std::span<const Pair> candidates) {
    PairErrors errors;
    const auto invalid = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        return std::binary_search(truth.invalid.begin(), truth.invalid.end(), std::array{body, tetrahedron});
    };
    PairCursor touching(truth.touching, candidates.front()),
        overlapping(truth.overlapping, candidates.front());
    for (const auto& pair : candidates) {
        if (touching.contains(pair))
            ++errors.touching;
        else if (overlapping.contains(pair))
            ++errors.overlapping;
        else if (invalid(pair.body_a, pair.tet_a) || invalid(pair.body_b, pair.tet_b))
            ++errors.invalid;
        else
            ++errors.disjoint;
    }
    return errors;
}

} // namespace

FrameTruth frame_truth(const Scene& scene, const Frame& frame, Positions positions, const Report& report,
                       std::uint64_t memory) {
    const auto fixed_bytes = tetrahedron_count(scene) * (sizeof(TetraCorners) + sizeof(Box));
    check_memory(scene, fixed_bytes, memory);
    FrameTruth truth;
    const PosedBodies world(scene, frame, positions);
    std::vector<Boxes> boxes(world.count());
    parallel_for(boxes.size(), [&](std::size_t body) { boxes[body] = world.boxes(body); });
    truth.invalid = invalid_of(boxes);
    for_near_blocks({scene, boxes, positions.self, fixed_bytes, memory}, report,
                    [&](std::span<const Pair> pairs) { add_intersecting(world, pairs, truth); });
    parallel_sort(truth.touching);
    parallel_sort(truth.overlapping);
    return truth;
}

std::vector<Decision> decide_pairs(const Scene& scene, const Frame& frame, Positions positions,
                                   std::span<const Pair> pairs) {
    return decide_all(PosedBodies(scene, frame, positions), pairs);
}

std::vector<std::array<TetraCorners, 2>> pair_corners(const Scene& scene, const Frame& frame,
                                                      Positions positions, std::span<const Pair> pairs) {
    std::vector<std::array<TetraCorners, 2>> corners;
    if (pairs.empty()) return corners;
    const auto world = world_of(scene, frame, positions.precision, positions.origin);
    for (const auto& pair : pairs)
        corners.push_back({world[pair.body_a][pair.tet_a], world[pair.body_b][pair.tet_b]});
    return corners;
}

void PairErrors::add(const PairErrors& other) {
    candidates += other.candidates;
    disjoint += other.disjoint;
    touching += other.touching;
    overlapping += other.overlapping;
    invalid += other.invalid;
    missed_touching += other.missed_touching;
    missed_overlapping += other.missed_overlapping;
}

PairErrors pair_errors(const FrameTruth& truth, std::span<const Pair> candidates) {
    const auto parts = in_parts(candidates);
    std::vector<PairErrors> found(parts.size());
    parallel_for(parts.size(), [&](std::size_t i) { found[i] = errors_of(truth, parts[i]); });
    PairErrors errors;
    for (const auto& part : found) errors.add(part);
    errors.candidates = candidates.size();
    errors.missed_touching = truth.touching.size() - errors.touching;
    errors.missed_overlapping = truth.overlapping.size() - errors.overlapping;
    return errors;
}

} // namespace tandem
