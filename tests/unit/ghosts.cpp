// SPDX-License-Identifier: MIT
// Ghost bodies of many ranks, which are threads of this process.
#include "algorithms/distributed/ghost_exchange.h"
#include "tests/support/thread_ranks.h"

#include <gtest/gtest.h>
#include <numeric>

namespace tandem {
namespace {

constexpr std::size_t rank_count = 64;

/// Shares of 64 ranks of a pile, by rank, as they have found them together.
std::vector<Subdomain> shares_of(const Scene& scene, const Frame& frame) {
    std::vector<std::uint32_t> all(scene.bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    DisplacementTracker places(scene);
    places.set_reference(frame, all);
    std::vector<Ball> balls;
    for (const auto body : all) balls.push_back(places.ball(body));
    Partitioner deal(scene, {.k = 18}, rank_count);
    deal.partition(balls, std::vector<double>(rank_count, 1));
    std::vector<Subdomain> shares(rank_count);
    testing_support::ThreadJob(rank_count).run([&](Ranks& ranks) {
        const auto rank = static_cast<std::size_t>(ranks.rank());
        GhostExchange halo(scene, {.k = 18}, ranks);
        GhostExchange::Traffic traffic;
        halo.rebuild(deal.subdomains()[rank].own, frame, traffic);
        shares[rank] = halo.subdomain();
    });
    return shares;
}

TEST(Ghosts, OfManyRanksHaveEachPairOnce) {
    const auto scene = make_scene("pile:bodies=600,mesh=grain1,density=0.1,frames=1");
    const auto frame = scene.frame(0);
    std::vector<std::vector<Role>> roles;
    std::size_t ghosts = 0, ranks_with_ghosts = 0;
    for (const auto& share : shares_of(scene, frame)) {
        roles.push_back(roles_of(share, scene.bodies.size()));
        ghosts += share.ghosts.size();
        ranks_with_ghosts += share.ghosts.empty() ? 0 : 1;
    }
    const auto pairs = BroadSweep(scene, {.k = 18}, Broad::tight).pairs(frame);
    ASSERT_GT(pairs.size(), 600u);
    for (const auto& pair : pairs) {
        std::size_t times = 0;
        for (const auto& own : roles)
            times += own[pair.a] != Role::none && own[pair.b] != Role::none
                     && (own[pair.a] == Role::own || own[pair.b] == Role::own);
        EXPECT_EQ(times, 1u) << pair.a << " and " << pair.b;
    }
    EXPECT_GT(ranks_with_ghosts, rank_count / 2);
    EXPECT_LT(ghosts, rank_count * scene.bodies.size() / 4); // of no rank everything
}

} // namespace
} // namespace tandem
