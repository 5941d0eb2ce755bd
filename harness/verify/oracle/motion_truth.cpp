// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/motion_truth.h"

#include "harness/verify/oracle/near_pairs.h"
#include "harness/verify/oracle/turn.h"
#include "harness/verify/oracle/world.h"
#include "base/parallel.h"

#include <algorithm>

namespace tandem {

namespace {

using namespace oracle;

/// The paths of all bodies between two frames.
class MovingBodies {
public:
    MovingBodies(const Scene& scene, const Frame& from, const Frame& to, Positions positions)
        : scene_(scene),
          frames_{&from, &to},
          world_{world_of(scene, from, positions.precision, positions.origin),
                 world_of(scene, to, positions.precision, positions.origin)},
          turns_(scene.bodies.size()) {
        for (std::size_t body = 0; body < turns_.size(); ++body)
            if (!scene.bodies[body].deformable) turns_[body] = Turn(from.poses[body], to.poses[body]);
    }

    std::vector<Boxes> boxes() const {
        std::vector<Boxes> result(turns_.size());
        parallel_for(result.size(), [&](std::size_t body) {
            const double off = turns_[body].angle > 0 ? turns_[body].leaves_chord(mesh(body).vertices) : 0;
            result[body] = boxes_at(0, body, off);
            result[body].join(boxes_at(1, body, off));
        });
        return result;
    }

    MeetingDecision decided(const Pair& pair) const {
        MeetingDecision result{Meeting::apart, MeetingTier::ends};
        const bool same = pair.body_a == pair.body_b;
        for (const bool way_a : ways(pair.body_a))
            for (const bool way_b : ways(pair.body_b)) {
                if (same && way_a != way_b) continue;
                const auto found = meet_in_motion(moving(pair.body_a, pair.tet_a, way_a),
                                                  moving(pair.body_b, pair.tet_b, way_b));
                result.tier = std::max(result.tier, found.tier);
                if (found.meeting == Meeting::meeting) return {Meeting::meeting, result.tier};
                if (found.meeting == Meeting::undecided) result.meeting = Meeting::undecided;
            }
        return result;
    }

private:
    const Mesh& mesh(std::size_t body) const { return scene_.meshes[scene_.bodies[body].mesh]; }

    Boxes boxes_at(unsigned end, std::size_t body, double off) const {
        return Boxes(world_[end][body], skipped_in(scene_, *frames_[end], body), off);
    }

    /// Whether the body turns the other way; both for a turn of 180 degrees.
    std::span<const bool> ways(std::uint32_t body) const {
        static constexpr bool both[] = {false, true};
        return std::span(both).first(turns_[body].either ? 2 : 1);
    }

    MovingTetra moving(std::uint32_t body, std::uint32_t tetrahedron, bool other_way) const {
        MovingTetra result{.from = world_[0][body][tetrahedron], .to = world_[1][body][tetrahedron]};
        if (turns_[body].angle == 0) return result;
        std::array<Eigen::Vector3d, 4> corners;
        for (unsigned i = 0; i < 4; ++i)
            corners[i] = mesh(body).vertices[mesh(body).tetrahedra[tetrahedron][i]];
        turns_[body].bend(result, corners, other_way);
        return result;
    }

    const Scene& scene_;
    std::array<const Frame*, 2> frames_;
    std::array<World, 2> world_;
    std::vector<Turn> turns_; ///< by body
};

/// Decides pairs and stores those that may meet.
void add_meeting(const MovingBodies& bodies, std::span<const Pair> pairs, MotionTruth& truth) {
    std::vector<MeetingDecision> decisions(pairs.size());
    constexpr std::size_t part = 64; // a pair can take milliseconds
    parallel_for((pairs.size() + part - 1) / part, [&](std::size_t index) {
        const auto end = std::min(pairs.size(), (index + 1) * part);
        for (auto i = index * part; i < end; ++i) decisions[i] = bodies.decided(pairs[i]);
    });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        ++truth.tiers[static_cast<unsigned>(decisions[i].tier)];
        if (decisions[i].meeting == Meeting::meeting) truth.colliding.push_back(pairs[i]);
        if (decisions[i].meeting == Meeting::undecided) truth.undecided.push_back(pairs[i]);
    }
}

} // namespace

MotionTruth motion_truth(const Scene& scene, const Frame& from, const Frame& to, Positions positions,
                         const TruthOptions& options) {
    const auto fixed_bytes = tetrahedron_count(scene) * 2 * (sizeof(TetraCorners) + sizeof(Box));
    check_memory(scene, fixed_bytes, options.memory);
    MotionTruth truth;
    const MovingBodies bodies(scene, from, to, positions);
    const auto boxes = bodies.boxes();
    truth.invalid = invalid_of(boxes);
    for_near_blocks({scene, boxes, positions.self, fixed_bytes, options.memory}, options.report,
                    [&](std::span<const Pair> pairs) { add_meeting(bodies, pairs, truth); });
    parallel_sort(truth.colliding);
    parallel_sort(truth.undecided);
    return truth;
}

} // namespace tandem
