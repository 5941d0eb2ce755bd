// SPDX-License-Identifier: MIT
// Ghost bodies of a rank, and those of the next rebuild, against bounds of all bodies.
#include "algorithms/distributed/ghost_exchange.h"

#include "tests/ranks/job.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using testing::UnorderedElementsAreArray;

using Numbers = std::vector<std::uint32_t>;

// fractions of a radius, as in ghost_exchange.cpp before skins grow
constexpr double skin = 0.25, next_skin = 0.5;

/// A partitioned pile in which some bodies are fixed.
struct PartitionedPile {
    PartitionedPile()
        : frame(scene.frame(0)),
          tracker(scene),
          partitioner(scene, geometry, static_cast<std::size_t>(job->size())) {
        Numbers all(scene.bodies.size());
        std::iota(all.begin(), all.end(), 0u);
        tracker.set_reference(frame, all);
        std::vector<Ball> balls;
        for (const auto body : all) balls.push_back(tracker.ball(body));
        partitioner.partition(balls, std::vector<double>(static_cast<std::size_t>(job->size()), 1));
    }

    static Scene some_fixed() {
        auto scene = make_scene("pile:bodies=400,mesh=grain1,density=0.05,frames=1");
        for (const auto body : {0, 50, 100, 200}) scene.bodies[static_cast<std::size_t>(body)].fixed = true;
        return scene;
    }

    std::vector<double> slab(std::uint32_t body, double fraction) const {
        std::vector<double> ends(2 * sweep.axes());
        sweep.bound(frame, body, fraction * tracker.ball(body).radius, ends.data());
        return ends;
    }
    /// Bodies that are fixed or owned by later ranks, and overlap one of `own` whose bounds are wider by that
    /// fraction.
    Numbers near(const Numbers& own, double wider) const {
        Numbers found;
        for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
            if (partitioner.owner_of(body) <= static_cast<std::size_t>(job->rank())) continue;
            const auto box = slab(body, skin);
            if (std::ranges::any_of(own, [&](auto one) { return overlap(slab(one, skin + wider), box); }))
                found.push_back(body);
        }
        return found;
    }
    static bool overlap(const std::vector<double>& a, const std::vector<double>& b) {
        for (std::size_t i = 0; i < a.size(); i += 2)
            if (a[i] > b[i + 1] || b[i] > a[i + 1]) return false;
        return true;
    }

    Geometry geometry{.k = 18};
    Scene scene = some_fixed();
    Frame frame;
    DisplacementTracker tracker;
    Partitioner partitioner;
    BroadSweep sweep{scene, geometry, Broad::tight};
};

TEST(GhostExchange, ListsGhostsAndTheGhostsOfTheNextRebuild) {
    const PartitionedPile pile;
    const auto& own = pile.partitioner.subdomains()[static_cast<std::size_t>(job->rank())].own;
    GhostExchange ghost_exchange(pile.scene, pile.geometry, *job);
    GhostExchange::Traffic traffic;
    EXPECT_TRUE(ghost_exchange.is_expired(pile.frame, traffic));
    ghost_exchange.rebuild(own, pile.frame, traffic);
    const auto near = pile.near(own, 0);
    auto next = pile.near(own, next_skin);
    std::erase_if(next, [&](auto body) { return std::ranges::binary_search(near, body); });
    EXPECT_EQ(ghost_exchange.subdomain().own, own);
    EXPECT_THAT(ghost_exchange.subdomain().ghosts, UnorderedElementsAreArray(near));
    EXPECT_THAT(ghost_exchange.next_ghosts(), UnorderedElementsAreArray(next));
    if (job->rank() + 1 < job->size()) {
        EXPECT_GT(near.size(), 0u);
        EXPECT_GT(next.size(), 0u);
    }
    EXPECT_FALSE(ghost_exchange.is_expired(pile.frame, traffic));
}

} // namespace
} // namespace tandem
