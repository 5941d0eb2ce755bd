// SPDX-License-Identifier: MIT
// Ghost bodies of many ranks, which are threads of this process.
#include "algorithms/distributed/ghost_exchange.h"
#include "tests/support/test.h"
#include "tests/support/thread_ranks.h"

namespace tandem {
namespace {

constexpr std::size_t rank_count = 64;

/// Subdomains of a pile on 64 ranks, by rank, from a collective rebuild.
std::vector<Subdomain> subdomains_of(const Scene& scene, const Frame& frame) {
    std::vector<std::uint32_t> all(scene.bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    DisplacementTracker tracker(scene);
    tracker.set_reference(frame, all);
    std::vector<Ball> balls;
    for (const auto body : all) balls.push_back(tracker.ball(body));
    Partitioner partitioner(scene, {.k = 18}, rank_count);
    partitioner.partition(balls, std::vector<double>(rank_count, 1));
    std::vector<Subdomain> subdomains(rank_count);
    support::ThreadJob(rank_count).run([&](Ranks& ranks) {
        const auto rank = static_cast<std::size_t>(ranks.rank());
        GhostExchange ghost_exchange(scene, {.k = 18}, ranks);
        GhostExchange::Traffic traffic;
        ghost_exchange.rebuild(partitioner.subdomains()[rank].own, frame, traffic);
        subdomains[rank] = ghost_exchange.subdomain();
    });
    return subdomains;
}

TEST(Ghosts, OfManyRanksHaveEachPairOnce) {
    const auto scene = make_scene("pile:bodies=600,mesh=grain1,density=0.1,frames=1");
    const auto frame = scene.frame(0);
    std::vector<std::vector<Role>> roles;
    std::size_t ghosts = 0, ranks_with_ghosts = 0;
    for (const auto& subdomain : subdomains_of(scene, frame)) {
        roles.push_back(roles_of(subdomain, scene.bodies.size()));
        ghosts += subdomain.ghosts.size();
        ranks_with_ghosts += subdomain.ghosts.empty() ? 0 : 1;
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
    EXPECT_LT(ghosts, rank_count * scene.bodies.size() / 4); // no rank has every body as a ghost
}

} // namespace
} // namespace tandem
