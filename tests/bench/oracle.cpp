// SPDX-License-Identifier: MIT
// The oracle: time per pair by family, and time of a million candidate pairs of a scene on all cores.
#include "geometry/contact_truth.h"
#include "harness/verify/oracle/frame_truth.h"
#include "harness/verify/reference.h"
#include "tests/support/oracle_pairs.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <vector>

namespace tandem {
namespace {

using namespace support;

constexpr std::size_t pair_count = 2000;

template<class Make>
std::vector<OraclePair> pairs_of(Make make) {
    std::vector<OraclePair> pairs;
    for (std::size_t i = 0; i < pair_count; ++i) pairs.push_back(make());
    return pairs;
}

/// One iteration is one pair.
void decisions(benchmark::State& state, const std::vector<OraclePair>& pairs) {
    std::size_t i = 0;
    DecisionCounts counts;
    for ([[maybe_unused]] auto _ : state) {
        counts.add(decide(pairs[i].a, pairs[i].b));
        i = i + 1 < pairs.size() ? i + 1 : 0;
    }
    const auto fraction = [&](auto what) {
        return static_cast<double>(counts[what]) / static_cast<double>(state.iterations());
    };
    state.counters["overlapping"] = fraction(Relation::overlapping);
    state.counters["touching"] = fraction(Relation::touching);
    state.counters["filtered"] = fraction(Tier::screen) + fraction(Tier::filter);
}

void contacts(benchmark::State& state, const std::vector<OraclePair>& pairs) {
    std::size_t i = 0;
    for ([[maybe_unused]] auto _ : state) {
        benchmark::DoNotOptimize(contact_truth(pairs[i].a, pairs[i].b));
        i = i + 1 < pairs.size() ? i + 1 : 0;
    }
}

/// A million candidate pairs that the reference finds in a crowded pile, with the motion of the vertices.
void million(benchmark::State& state) {
    static const auto scene = make_scene("pile:bodies=64,frames=1,density=0.6");
    static const auto frame = scene.frame(0);
    static auto pairs = reference(scene, frame, {}, false, Method::sweep).pairs;
    static const auto found = pairs.size();
    while (pairs.size() < 1000000)
        pairs.insert(pairs.end(), pairs.begin(), pairs.begin() + static_cast<long>(found));
    pairs.resize(1000000);
    for ([[maybe_unused]] auto _ : state)
        benchmark::DoNotOptimize(decide_pairs(scene, frame, Precision::fp32, pairs));
    state.counters["candidates"] = static_cast<double>(found);
}

void add(const std::string& family, const std::vector<OraclePair>& pairs) {
    benchmark::RegisterBenchmark(fmt::format("oracle/{}", family).c_str(),
                                 [pairs](auto& state) { decisions(state, pairs); });
    benchmark::RegisterBenchmark(fmt::format("oracle contact/{}", family).c_str(),
                                 [pairs](auto& state) { contacts(state, pairs); });
}

} // namespace

void register_oracle() {
    for (unsigned family = 0; family < static_cast<unsigned>(Family::count); ++family) {
        Random random(family);
        add(name(static_cast<Family>(family)),
            pairs_of([&] { return random_pair(static_cast<Family>(family), random); }));
    }
    TouchMaker make(1);
    constexpr const char* names[] = {"corner", "edge", "face"};
    for (unsigned of_b = 1; of_b <= 3; ++of_b)
        for (const bool wide : {false, true})
            add(fmt::format("{} on face, {}", names[of_b - 1], wide ? "24 bits" : "few bits"),
                pairs_of([&] { return make.touching(3, of_b, wide ? 1 << 17 : 4); }));
    add("gap of 1 ulp", pairs_of([&] { return make.one_ulp(1); }));
    add("1 ulp through", pairs_of([&] { return make.one_ulp(-1); }));
    add("nested", pairs_of([&] { return make.nested(); }));
    const TetraCorners flat{{{0, 0, 0.25}, {1, 0, 0.25}, {0, 1, 0.25}, {1, 1, 0.25}}};
    const TetraCorners unit{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    add("no volume", {{flat, unit}});
    benchmark::RegisterBenchmark("oracle, a million pairs", million)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
}

} // namespace tandem
