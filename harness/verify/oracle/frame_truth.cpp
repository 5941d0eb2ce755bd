// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/frame_truth.h"

#include "algorithms/bodies/drift.h"
#include "algorithms/bodies/self_pairs.h"
#include "harness/verify/oracle/posed.h"
#include "harness/verify/oracle/superset.h"
#include "harness/verify/world_vertices.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <numeric>

namespace tandem {

namespace {

using namespace oracle;

/// Corners of all tetrahedra of every body.
using World = std::vector<std::vector<TetraCorners>>;

/// Converts corners of either precision to double, which is exact.
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
    return precision == Precision::fp64 ? world_in<double>(scene, frame) : world_in<float>(scene, frame);
}

/// The input of the decision.
class Bodies {
public:
    Bodies(const Scene& scene, const Frame& frame, Positions positions)
        : scene_(scene),
          frame_(frame),
          world_(world_of(scene, frame, positions.precision)),
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
        const std::span<const std::uint32_t> none;
        return Boxes(world_[body], frame_.skipped.empty() ? none : frame_.skipped[body], off_[body]);
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

std::vector<Decision> decide_all(const Bodies& bodies, std::span<const Pair> pairs) {
    std::vector<Decision> result(pairs.size());
    constexpr std::size_t part = 1024;
    parallel_for((pairs.size() + part - 1) / part, [&](std::size_t index) {
        const auto end = std::min(pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i) result[i] = bodies.decided(pairs[i]);
    });
    return result;
}

using BodyNumbers = std::array<std::uint32_t, 2>;

/// Pairs of bodies that may meet and whose boxes overlap, and those of setting self.
std::vector<BodyNumbers> near_bodies(const Scene& scene, const std::vector<Boxes>& boxes, SelfPairs self) {
    std::vector<BodyNumbers> result;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
        if (meets_itself(scene, a, self)) result.push_back({a, a});
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
            if (may_meet(scene, a, b) && boxes_overlap(boxes[a].whole, boxes[b].whole))
                result.push_back({a, b});
    }
    return result;
}

/// Calls visit(tetrahedron of a, of b) for the near pairs of two bodies, or of one body without common
/// vertices.
template<class Visit>
void for_near_pairs_of(const Scene& scene, const std::vector<Boxes>& boxes, BodyNumbers bodies, Visit visit) {
    const auto [a, b] = bodies;
    if (a != b) {
        for_near_pairs(boxes[a], boxes[b], visit);
        return;
    }
    const auto& tetrahedra = scene.meshes[scene.bodies[a].mesh].tetrahedra;
    for_near_pairs(boxes[a], boxes[a], [&](std::uint32_t t, std::uint32_t u) {
        if (t >= u) return; // the other order of each pair, and a tetrahedron with itself
        for (const auto vertex : tetrahedra[t])
            if (std::ranges::find(tetrahedra[u], vertex) != tetrahedra[u].end()) return;
        visit(t, u);
    });
}

/// Decides pairs in blocks and stores those that intersect. Calls `report` with the number of decided pairs.
void add_intersecting(const Bodies& bodies, std::span<const Pair> pairs, FrameTruth& truth,
                      const std::function<void(std::size_t)>& report) {
    constexpr std::size_t block = 1 << 18;
    for (std::size_t first = 0; first < pairs.size(); first += block) {
        const auto part = pairs.subspan(first, std::min(block, pairs.size() - first));
        const auto decisions = decide_all(bodies, part);
        for (std::size_t i = 0; i < part.size(); ++i) {
            truth.decisions.add(decisions[i]);
            if (decisions[i].relation == Relation::touching) truth.touching.push_back(part[i]);
            if (decisions[i].relation == Relation::overlapping) truth.overlapping.push_back(part[i]);
        }
        report(first + part.size());
    }
}

/// Number of near pairs of tetrahedra for each pair of bodies. Stops early, with incomplete counts, once the
/// total exceeds `most`.
std::vector<std::uint64_t> count_near(const Scene& scene, const std::vector<Boxes>& boxes,
                                      std::span<const BodyNumbers> bodies, std::uint64_t most) {
    std::vector<std::uint64_t> counts(bodies.size());
    std::atomic<std::uint64_t> total = 0;
    parallel_for(bodies.size(), [&](std::size_t i) {
        if (total > most) return;
        std::uint64_t count = 0; // a local variable, because other threads write to neighbouring elements
        for_near_pairs_of(scene, boxes, bodies[i], [&](auto, auto) { ++count; });
        counts[i] = count;
        total += counts[i];
    });
    return counts;
}

/// The near pairs of some pairs of bodies; `counts` has their number for each.
std::vector<Pair> near_pairs(const Scene& scene, const std::vector<Boxes>& boxes,
                             std::span<const BodyNumbers> bodies, std::span<const std::uint64_t> counts) {
    std::vector<std::uint64_t> starts(bodies.size() + 1);
    std::partial_sum(counts.begin(), counts.end(), starts.begin() + 1);
    std::vector<Pair> pairs(starts.back());
    parallel_for(bodies.size(), [&](std::size_t i) {
        const auto [a, b] = bodies[i];
        auto* next = pairs.data() + starts[i];
        for_near_pairs_of(scene, boxes, bodies[i], [&, a = a, b = b](auto ta, auto tb) {
            *next++ = {a, ta, b, tb};
        });
    });
    return pairs;
}

/// Memory of a near pair: one copy to decide, and up to two in a result list that grows by doubling.
constexpr std::uint64_t pair_bytes = 3 * sizeof(Pair);

[[noreturn]] void refuse(std::uint64_t tetrahedra, std::string_view more, std::uint64_t pairs,
                         std::uint64_t bytes, std::uint64_t memory) {
    constexpr double gib = 1 << 30;
    throw InputError(fmt::format("the exact truth of {} tetrahedra with {}{} pairs near each other may take "
                                 "{:.2f} GiB, and {:.2f} GiB are free; choose --truth none, fewer frames or "
                                 "fewer bodies",
                                 tetrahedra, more, pairs, static_cast<double>(bytes) / gib,
                                 static_cast<double>(memory) / gib));
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
    const auto tetrahedra = tetrahedron_count(scene);
    // Allocated before the number of near pairs is known.
    const auto fixed_bytes = tetrahedra * (sizeof(TetraCorners) + sizeof(Box));
    if (fixed_bytes > memory) refuse(tetrahedra, "at least ", 0, fixed_bytes, memory);
    FrameTruth truth;
    const Bodies world(scene, frame, positions);
    std::vector<Boxes> boxes(world.count());
    parallel_for(boxes.size(), [&](std::size_t body) { boxes[body] = world.boxes(body); });
    for (std::uint32_t body = 0; body < boxes.size(); ++body)
        for (const auto tetrahedron : boxes[body].invalid) truth.invalid.push_back({body, tetrahedron});
    const auto bodies = near_bodies(scene, boxes, positions.self);
    const auto most = (memory - fixed_bytes) / pair_bytes;
    const auto counts = count_near(scene, boxes, bodies, most);
    const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (total > most) refuse(tetrahedra, "at least ", total, fixed_bytes + total * pair_bytes, memory);
    // Pairs of bodies in one batch, so that not all near pairs are in memory at once.
    constexpr std::size_t batch = 256;
    std::uint64_t decided = 0;
    for (std::size_t first = 0; first < bodies.size(); first += batch) {
        const auto count = std::min(batch, bodies.size() - first);
        const auto pairs = near_pairs(scene, boxes, std::span(bodies).subspan(first, count),
                                      std::span(counts).subspan(first, count));
        add_intersecting(world, pairs, truth, [&](std::size_t done) {
            const auto fraction = static_cast<double>(decided + done) / static_cast<double>(total);
            if (report) report(fraction, decided + done);
        });
        decided += pairs.size();
    }
    parallel_sort(truth.touching);
    parallel_sort(truth.overlapping);
    return truth;
}

std::vector<Decision> decide_pairs(const Scene& scene, const Frame& frame, Positions positions,
                                   std::span<const Pair> pairs) {
    return decide_all(Bodies(scene, frame, positions), pairs);
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
