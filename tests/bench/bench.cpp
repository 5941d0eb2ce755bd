// SPDX-License-Identifier: MIT
// Microbenchmarks of the stages, on every available device. The host times iterations around one wait.
// Compare times within one run only; times on a processor do not predict those on a GPU.
#include "algorithms/hierarchy/ceilings.cl.h"
#include "algorithms/broad_phase/broad.h"
#include "algorithms/broad_phase/broad_stage.h"
#include "algorithms/narrow_phase/reference.h"
#include "tests/support/prepared_trees.h"
#include "algorithms/distributed/displacement_tracker.h"
#include "algorithms/kernels/sources.h"
#include "algorithms/kernels/status.clh"
#include "algorithms/traversal.h"
#include "backends/registry.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <numeric>

namespace tandem {

void register_oracle();
void register_partition();

namespace {

const Scene& jacks() {
    static const auto scene = make_scene("pile:bodies=64,frames=2");
    return scene;
}

std::uint32_t group_size(const Device& device) { return device.info().max_group_size == 1 ? 1 : 64; }

void transfer(benchmark::State& state, Device& device, bool up) {
    std::vector<std::byte> bytes(static_cast<std::size_t>(state.range(0)));
    const auto buffer = device.allocate(bytes.size(), "transfer");
    const StageScope scope(device, up ? Stage::write : Stage::read);
    for ([[maybe_unused]] auto _ : state) {
        if (up)
            device.upload(buffer, bytes, 0, true);
        else
            device.download(buffer, bytes);
        device.finish();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0));
}

/// Launches an empty kernel and waits for it.
void launch_latency(benchmark::State& state, Device& device) {
    KernelOf<kernels::ceilings::DoNothing> kernel;
    compile_kernel(device, kernel, geometry_defines({}, group_size(device)));
    const auto empty = device.allocate(64, "empty");
    const StageScope scope(device, Stage::traverse);
    const kernels::ceilings::DoNothing arguments{.out = empty};
    device.launch(kernel, {1, group_size(device)}, arguments);
    device.finish();
    for ([[maybe_unused]] auto _ : state) {
        device.launch(kernel, {1, group_size(device)}, arguments);
        device.finish();
    }
}

void refit(benchmark::State& state, Device& device) {
    support::PreparedTrees scene(device, jacks(), {.k = static_cast<int>(state.range(0))}, 32,
                                 group_size(device));
    const auto frame = jacks().frame(0);
    scene.update(frame); // PoCL compiles for a group size at the first launch
    device.finish();
    for ([[maybe_unused]] auto _ : state) {
        scene.update(frame);
        device.finish();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * scene.trees.slots() * 4)
                            * state.range(0));
}

/// One frame of an algorithm. Contacts on and off give the contact kernel's fraction; a seed threshold of 1
/// gives the fraction of seeding.
void frame(benchmark::State& state, Device& device, const std::string& name, const SettingTexts& given) {
    const auto& traversal = algorithm(name);
    const auto settings = resolve(traversal.parameters(), {}, given, name);
    const std::array devices{&device};
    const auto session = traversal.prepare(devices, jacks(), settings);
    const auto first = jacks().frame(0);
    const auto pairs = BroadSweep(jacks(), geometry_of(settings), Broad::sphere).pairs(first);
    auto found = session->run(first, pairs).count;
    device.finish();
    for ([[maybe_unused]] auto _ : state) {
        found = session->run(first, pairs).count;
        device.finish();
    }
    state.counters["pairs"] = static_cast<double>(found);
    state.counters["pairs/s"] =
        benchmark::Counter(static_cast<double>(found), benchmark::Counter::kIsIterationInvariantRate);
}

/// Body pairs on the device after refit: kernels and the wait for them.
void broad_on_device(benchmark::State& state, Device& device) {
    const auto scene = make_scene(fmt::format("pile:bodies={},mesh=grain1,frames=1", state.range(0)));
    support::PreparedTrees on(device, scene, {}, 32, group_size(device));
    BroadStage stage(on.bodies, on.trees.volumes(), {group_size(device), 64 * device.info().compute_units});
    const StageScope scope(device, Stage::broad);
    const auto status = device.allocate(STATUS_WORDS * 4, "status");
    const auto capacity = static_cast<std::uint32_t>(std::min<std::uint64_t>(stage.most_pairs(), 1 << 22));
    const auto pairs = device.allocate(std::size_t{capacity} * sizeof(BodyPair), "body pairs");
    const auto frame = scene.frame(0);
    on.update(frame);
    stage.sort(frame);
    stage.launch(pairs, capacity, status);
    device.finish();
    for ([[maybe_unused]] auto _ : state) {
        device.clear(status, STATUS_WORDS * 4);
        stage.launch(pairs, capacity, status);
        device.finish();
    }
    state.SetComplexityN(state.range(0));
}

void broad(benchmark::State& state, Broad bound) {
    const auto scene = make_scene(fmt::format("pile:bodies={},mesh=grain1,frames=1", state.range(0)));
    const BroadSweep search(scene, {}, bound);
    const auto first = scene.frame(0);
    for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(search.pairs(first));
    state.SetComplexityN(state.range(0));
}

/// Per-frame check of a rank: all bodies are within their skins.
void within_skins(benchmark::State& state) {
    const auto scene = make_scene(fmt::format("pile:bodies={},frames=1", state.range(0)));
    const auto frame = scene.frame(0);
    std::vector<std::uint32_t> all(scene.bodies.size());
    std::iota(all.begin(), all.end(), 0u);
    DisplacementTracker tracker(scene);
    tracker.set_reference(frame, all);
    for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(tracker.all_within(frame, all, 0.25));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * state.range(0));
}

/// Preparation; its time must be linear in the number of bodies.
void prepare(benchmark::State& state, Device& device) {
    const auto scene = make_scene(fmt::format("pile:bodies={},frames=1", state.range(0)));
    const auto& traversal = algorithm("chunked");
    const std::array devices{&device};
    for ([[maybe_unused]] auto _ : state) {
        traversal.prepare(devices, scene, resolve(traversal.parameters(), {}, {}, traversal.name()));
        device.finish();
    }
    state.SetComplexityN(state.range(0));
}

void register_for(Device& device) {
    const auto name = [&](std::string_view what) { return fmt::format("{}/{}", what, device.info().id); };
    const auto add = [&](std::string_view what, auto call) {
        return benchmark::RegisterBenchmark(name(what).c_str(), call)
            ->Unit(benchmark::kMicrosecond)
            ->UseRealTime();
    };
    add("upload", [&](auto& state) { transfer(state, device, true); })->Arg(4096)->Arg(1 << 24);
    add("download", [&](auto& state) { transfer(state, device, false); })->Arg(4096)->Arg(1 << 24);
    add("launch", [&](auto& state) { launch_latency(state, device); });
    add("refit", [&](auto& state) { refit(state, device); })->Arg(8)->Arg(18)->Arg(26);
    add("prepare", [&](auto& state) { prepare(state, device); })
        ->Arg(50)
        ->Arg(100)
        ->Arg(200)
        ->Complexity(benchmark::oN);
    add("broad, device", [&](auto& state) { broad_on_device(state, device); })
        ->Arg(200)
        ->Arg(2000)
        ->Arg(20000);
    const std::vector<std::pair<std::string, SettingTexts>> variants{
        {"contacts", {}},
        {"no contacts", {{"contact_rule", "none"}}},
        {"count only", {{"output", "count"}}},
        {"seeded from the top", {{"contact_rule", "none"}, {"seed_threshold", "1"}}}};
    for (const auto& [what, given] : variants)
        add(fmt::format("chunked, {}", what),
            [&device, given = given](auto& state) { frame(state, device, "chunked", given); });
    add("gproximity, contacts", [&](auto& state) { frame(state, device, "gproximity", {}); });
    add("gproximity, no contacts", [&](auto& state) {
        frame(state, device, "gproximity", {{"contact_rule", "none"}});
    });
}

} // namespace
} // namespace tandem

int main(int argc, char** argv) {
    const auto backends = tandem::discover();
    for (const auto& backend : backends)
        for (const auto& device : backend.devices) tandem::register_for(*device);
    for (const auto& [name, bound] :
         {std::pair{"broad, sphere", tandem::Broad::sphere}, std::pair{"broad, tight", tandem::Broad::tight}})
        benchmark::RegisterBenchmark(name, [bound = bound](auto& state) { tandem::broad(state, bound); })
            ->Arg(200)
            ->Arg(2000)
            ->Arg(20000)
            ->Unit(benchmark::kMicrosecond);
    benchmark::RegisterBenchmark("still near", tandem::within_skins)
        ->Arg(10'000)
        ->Arg(100'000)
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime();
    tandem::register_oracle();
    tandem::register_partition();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
