// SPDX-License-Identifier: MIT
// Microbenchmarks with many ranks in one process: the partitioner, which each rank runs by itself for all
// bodies, and the ghost lists, which the ranks build together. The scene is a pile of jacks, density 0.2.
#include "algorithms/distributed/ghost_exchange.h"
#include "tests/support/thread_ranks.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <mutex>
#include <numeric>

namespace tandem {

namespace {

/// A pile and the bounding balls of its bodies.
struct BoundedPile {
    explicit BoundedPile(std::int64_t bodies)
        : scene(make_scene(fmt::format("pile:bodies={},frames=1", bodies))), frame(scene.frame(0)) {
        std::vector<std::uint32_t> all(scene.bodies.size());
        std::iota(all.begin(), all.end(), 0u);
        DisplacementTracker tracker(scene);
        tracker.set_reference(frame, all);
        for (const auto body : all) balls.push_back(tracker.ball(body));
    }

    Scene scene;
    Frame frame;
    std::vector<Ball> balls;
};

/// Mean and maximum over parts or ranks.
struct Spread {
    double sum = 0, most = 0;
    std::size_t count = 0;

    void add(double value) {
        sum += value;
        most = std::max(most, value);
        ++count;
    }
    double mean() const { return sum / static_cast<double>(std::max<std::size_t>(count, 1)); }
};

/// Arguments: parts, bodies per part. Counters: own bodies (maximum) and ghost bodies by their balls (mean,
/// maximum).
void partition(benchmark::State& state) {
    const auto parts = static_cast<std::size_t>(state.range(0));
    const BoundedPile pile(state.range(0) * state.range(1));
    const std::vector<double> speeds(parts, 1.0);
    Partitioner partitioner(pile.scene, {.k = 18}, parts);
    for ([[maybe_unused]] auto _ : state) partitioner.partition(pile.balls, speeds);
    Spread own, ghosts;
    for (const auto& subdomain : partitioner.subdomains()) {
        own.add(static_cast<double>(subdomain.own.size()));
        ghosts.add(static_cast<double>(subdomain.ghosts.size()));
    }
    state.counters["own_most"] = own.most;
    state.counters["ghosts_mean"] = ghosts.mean();
    state.counters["ghosts_most"] = ghosts.most;
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0) * state.range(1));
}

/// Counters of one rank's ghost exchange.
struct GhostCounts {
    Spread ghosts, neighbours, setup_bytes, frame_bytes;
};

void add_rank(const Subdomain& subdomain, const Partitioner& partitioner, std::uint64_t setup,
              std::uint64_t frame, GhostCounts& counts) {
    std::vector<std::size_t> owners;
    for (const auto body : subdomain.ghosts) owners.push_back(partitioner.owner_of(body));
    std::ranges::sort(owners);
    const auto repeated = std::ranges::unique(owners);
    counts.ghosts.add(static_cast<double>(subdomain.ghosts.size()));
    counts.neighbours.add(static_cast<double>(owners.size() - repeated.size()));
    counts.setup_bytes.add(static_cast<double>(setup));
    counts.frame_bytes.add(static_cast<double>(frame));
}

/// Arguments: ranks, bodies per rank. Ranks are threads, more than there are cores: the time is that of all
/// of them together, not of one rank. Counters per rank: ghost bodies, ranks that own them, bytes sent at
/// set-up and per frame.
void ghosts(benchmark::State& state) {
    const auto ranks = static_cast<std::size_t>(state.range(0));
    const BoundedPile pile(state.range(0) * state.range(1));
    Partitioner partitioner(pile.scene, {.k = 18}, ranks);
    partitioner.partition(pile.balls, std::vector<double>(ranks, 1.0));
    GhostCounts counts;
    std::mutex counting;
    for ([[maybe_unused]] auto _ : state) {
        counts = {};
        support::ThreadJob(ranks).run([&](Ranks& own) {
            GhostExchange ghost_exchange(pile.scene, {.k = 18}, own);
            GhostExchange::Traffic setup, frame;
            const auto& subdomain = partitioner.subdomains()[static_cast<std::size_t>(own.rank())];
            ghost_exchange.rebuild(subdomain.own, pile.frame, setup);
            ghost_exchange.exchange_states(pile.frame, frame);
            const std::scoped_lock lock(counting);
            add_rank(ghost_exchange.subdomain(), partitioner, setup.bytes, frame.bytes, counts);
        });
    }
    for (const auto& [name, spread] :
         {std::pair{"ghosts", &counts.ghosts}, std::pair{"neighbours", &counts.neighbours},
          std::pair{"setup_bytes", &counts.setup_bytes}, std::pair{"frame_bytes", &counts.frame_bytes}}) {
        state.counters[fmt::format("{}_mean", name)] = spread->mean();
        state.counters[fmt::format("{}_most", name)] = spread->most;
    }
}

} // namespace

/// One iteration each: partitioning a million bodies takes seconds.
void register_partition() {
    const auto once = [](benchmark::internal::Benchmark* added) {
        return added->Iterations(1)->Repetitions(1)->Unit(benchmark::kMillisecond)->UseRealTime();
    };
    once(benchmark::RegisterBenchmark("partition, parts", partition))
        ->Args({4, 4200})
        ->Args({48, 4200})
        ->Args({238, 4200})
        ->Args({1024, 1000});
    once(benchmark::RegisterBenchmark("ghosts, ranks", ghosts))
        ->Args({8, 1000})
        ->Args({64, 250})
        ->Args({256, 64})
        ->Args({1024, 16});
}

} // namespace tandem
