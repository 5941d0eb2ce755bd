// SPDX-License-Identifier: MIT
#include "harness/verify/oracle/near_pairs.h"

#include "algorithms/bodies/self_pairs.h"
#include "geometry/decision.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <numeric>

namespace tandem::oracle {

namespace {

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
    const auto& mesh = scene.meshes[scene.bodies[a].mesh];
    for_near_pairs(boxes[a], boxes[a], [&](std::uint32_t t, std::uint32_t u) {
        if (t >= u) return; // the other order of each pair, and a tetrahedron with itself
        const auto other = joined(mesh, mesh.tetrahedra[u]);
        for (const auto vertex : joined(mesh, mesh.tetrahedra[t]))
            if (std::ranges::find(other, vertex) != other.end()) return;
        visit(t, u);
    });
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

} // namespace

void check_memory(const Scene& scene, std::uint64_t fixed_bytes, std::uint64_t memory) {
    if (fixed_bytes > memory) refuse(tetrahedron_count(scene), "at least ", 0, fixed_bytes, memory);
}

void for_near_blocks(const NearSearch& search, const std::function<void(double, std::uint64_t)>& report,
                     const std::function<void(std::span<const Pair>)>& visit) {
    const auto& [scene, boxes, self, fixed_bytes, memory] = search;
    const auto bodies = near_bodies(scene, boxes, self);
    const auto most = (memory - fixed_bytes) / pair_bytes;
    const auto counts = count_near(scene, boxes, bodies, most);
    const auto total = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    if (total > most)
        refuse(tetrahedron_count(scene), "at least ", total, fixed_bytes + total * pair_bytes, memory);
    // Pairs of bodies in one batch, so that not all near pairs are in memory at once.
    constexpr std::size_t batch = 256;
    constexpr std::size_t block = 1 << 18;
    std::uint64_t visited = 0;
    for (std::size_t first = 0; first < bodies.size(); first += batch) {
        const auto count = std::min(batch, bodies.size() - first);
        const auto pairs = near_pairs(scene, boxes, std::span(bodies).subspan(first, count),
                                      std::span(counts).subspan(first, count));
        for (std::size_t start = 0; start < pairs.size(); start += block) {
            const auto part = std::span(pairs).subspan(start, std::min(block, pairs.size() - start));
            visit(part);
            visited += part.size();
            if (report) report(static_cast<double>(visited) / static_cast<double>(total), visited);
        }
    }
}

} // namespace tandem::oracle
