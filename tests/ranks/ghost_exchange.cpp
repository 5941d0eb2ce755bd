// SPDX-License-Identifier: MIT
// Who is near bodies of a rank, and who is next, against bounds of all bodies.
#include "algorithms/distributed/ghost_exchange.h"

#include "tests/ranks/job.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

using testing::UnorderedElementsAreArray;

using Numbers = std::vector<std::uint32_t>;

constexpr double margin = 0.25, room = 0.5; // of a radius, as halo.cpp has them before margins grow

/// A pile some bodies of which are fixed, as ranks have dealt it.
struct DealtPile {
    DealtPile()
        : frame(scene.frame(0)), places(scene), deal(scene, geometry, static_cast<std::size_t>(job->size())) {
        Numbers all(scene.bodies.size());
        std::iota(all.begin(), all.end(), 0u);
        places.set_reference(frame, all);
        std::vector<Ball> balls;
        for (const auto body : all) balls.push_back(places.ball(body));
        deal.partition(balls, std::vector<double>(static_cast<std::size_t>(job->size()), 1));
    }

    static Scene some_fixed() {
        auto scene = make_scene("pile:bodies=400,mesh=grain1,density=0.05,frames=1");
        for (const auto body : {0, 50, 100, 200}) scene.bodies[static_cast<std::size_t>(body)].fixed = true;
        return scene;
    }

    std::vector<double> slab(std::uint32_t body, double share) const {
        std::vector<double> ends(2 * sweep.axes());
        sweep.bound(frame, body, share * places.ball(body).radius, ends.data());
        return ends;
    }
    /// Bodies that later ranks own, or that are fixed, and meet one of `own` whose bounds are so much wider.
    Numbers near(const Numbers& own, double wider) const {
        Numbers found;
        for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) {
            if (deal.owner_of(body) <= static_cast<std::size_t>(job->rank())) continue;
            const auto theirs = slab(body, margin);
            if (std::ranges::any_of(own,
                                    [&](auto one) { return overlap(slab(one, margin + wider), theirs); }))
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
    DisplacementTracker places;
    Partitioner deal;
    BroadSweep sweep{scene, geometry, Broad::tight};
};

TEST(GhostExchange, HasWhoIsNearAndKnowsWhoIsNext) {
    const DealtPile pile;
    const auto& own = pile.deal.subdomains()[static_cast<std::size_t>(job->rank())].own;
    GhostExchange halo(pile.scene, pile.geometry, *job);
    GhostExchange::Traffic traffic;
    EXPECT_TRUE(halo.is_expired(pile.frame, traffic));
    halo.rebuild(own, pile.frame, traffic);
    const auto near = pile.near(own, 0);
    auto next = pile.near(own, room);
    std::erase_if(next, [&](auto body) { return std::ranges::binary_search(near, body); });
    EXPECT_EQ(halo.subdomain().own, own);
    EXPECT_THAT(halo.subdomain().ghosts, UnorderedElementsAreArray(near));
    EXPECT_THAT(halo.next_ghosts(), UnorderedElementsAreArray(next));
    if (job->rank() + 1 < job->size()) {
        EXPECT_GT(near.size(), 0u);
        EXPECT_GT(next.size(), 0u);
    }
    EXPECT_FALSE(halo.is_expired(pile.frame, traffic));
}

} // namespace
} // namespace tandem
