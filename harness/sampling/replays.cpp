// SPDX-License-Identifier: MIT
#include "harness/plans/cell_session.h"
#include "harness/plans/rank_team.h"
#include "harness/sampling/replays.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

/// Device time from the begin of the first command to the end of the last; -1 when a command has no times.
std::int64_t device_span(const Trace& trace) {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    std::int64_t last = -1;
    for (const auto& event : trace.events) {
        if (event.command >= Command::wait) continue; // a wait, or the host's own
        if (event.begin_ns < 0 || event.device_ns < 0) return -1;
        first = std::min(first, event.begin_ns);
        last = std::max(last, event.begin_ns + event.device_ns);
    }
    return last < 0 ? -1 : last - first;
}

void add_kernels(const Trace& trace, std::map<std::string, KernelSample>& kernels) {
    for (const auto& event : trace.events) {
        if (event.command != Command::launch) continue;
        const auto [found, is_first] = kernels.try_emplace(event.label);
        auto& kernel = found->second;
        if (is_first && event.kernel != nullptr) kernel.facts = *event.kernel;
        kernel.device_ns += std::max<std::int64_t>(event.device_ns, 0);
        ++kernel.launches;
        kernel.stage = event.stage;
        kernel.groups = std::max(kernel.groups, event.groups);
        kernel.group_size = event.group_size;
    }
}

void add_host_work(const Trace& trace, std::map<std::string, HostWorkSample>& work) {
    for (const auto& event : trace.events) {
        if (event.command != Command::host_work) continue;
        auto& sum = work[event.label];
        sum.host_ns += event.host_ns;
        ++sum.times;
        sum.stage = event.stage;
    }
}

void add_phases(const Trace& trace, std::map<std::string, PhaseSample>& phases) {
    for (const auto& event : trace.events)
        if (event.command == Command::phase) phases[event.label].host_ns += event.host_ns;
}

/// Stage samples of a frame by device: this process's devices, or one device of each rank.
std::vector<StageSamples> stages_of(RankTeam* team, const std::vector<Trace>& traces) {
    std::vector<StageSamples> stages;
    for (const auto& trace : traces) stages.push_back(by_stage(trace));
    if (team == nullptr) return stages;
    const auto own = stages.front();
    stages.clear();
    for (const auto& bytes : team->gather(std::as_bytes(std::span(own))))
        stages.push_back(MessageReader(bytes).read<StageSamples>());
    return stages;
}

} // namespace

Replays::Replays(const Cell& cell, const Scene& scene, const FrameRange& range, std::function<bool()> stop)
    : cell_(cell), range_(range), stop_(std::move(stop)), name_(describe(cell)) {
    frame_names_.resize(range.size());
    if (ranges::available())
        for (std::size_t i = 0; i < frame_names_.size(); ++i)
            frame_names_[i] = fmt::format("frame {}", range.first() + i);
    for (auto* device : cell.devices) device->set_clocks(Clocks::off);
    const auto begin = Clock::now();
    session_ = prepare_session(cell, scene);
    wait();
    prepare_ns_ = since(begin);
}

void Replays::wait() {
    together(cell_.team, [&] {
        for (auto* device : cell_.devices) device->finish();
    });
}

/// Returns the frame once all ranks have it and all devices are idle.
FrameState Replays::next_frame(std::size_t index) {
    if (stop_()) throw Interrupted();
    FrameState frame;
    together(cell_.team, [&] {
        frame = range_.state(index, settings()[parameters::motion]);
        for (auto* device : cell_.devices) device->finish();
    });
    return frame;
}

std::uint64_t Replays::submissions() const {
    std::uint64_t sum = 0;
    for (const auto* device : cell_.devices) sum += device->submissions();
    return sum;
}

InstrumentedReplay Replays::instrumented() {
    session_->reset();
    for (auto* device : cell_.devices) device->set_clocks(Clocks::on);
    const ranges::ProfilerRange cell(name_.c_str());
    InstrumentedReplay replay;
    replay.by_device.resize(infos_of(cell_).size());
    for (std::size_t i = 0; i < range_.size(); ++i) {
        const auto frame = next_frame(i);
        const ranges::ProfilerRange stretch(frame_names_[i].c_str());
        const auto begin = Clock::now();
        const auto result = session_->run(FrameView(frame.input()).checked());
        replay.frame_ns.push_back(since(begin));
        std::vector<Trace> traces;
        together(cell_.team, [&] {
            for (auto* device : cell_.devices) traces.push_back(device->finish());
        });
        auto& sum = replay.stages.emplace_back();
        std::int64_t span = 0; // the longest device span; -1 when one is unknown
        for (const auto& trace : traces) {
            add_kernels(trace, replay.kernels);
            add_host_work(trace, replay.host_work);
            add_phases(trace, replay.phases);
            const auto own_span = device_span(trace);
            span = span < 0 || own_span < 0 ? -1 : std::max(span, own_span);
        }
        const auto stages = stages_of(cell_.team, traces);
        for (std::size_t number = 0; number < stages.size(); ++number)
            for (std::size_t stage = 0; stage < sum.size(); ++stage) {
                sum[stage] += stages[number][stage];
                replay.by_device[number][stage] += stages[number][stage];
            }
        replay.span_ns.push_back(span);
    }
    for (auto* device : cell_.devices) {
        replay.clocks.push_back(device->clock());
        device->set_clocks(Clocks::off);
    }
    return replay;
}

std::vector<Trace> Replays::traced(std::size_t index) {
    const ranges::ProfilerRange cell(name_.c_str());
    session_->reset();
    for (std::size_t i = 0; i < index; ++i) session_->run(FrameView(next_frame(i).input()).checked());
    const auto frame = next_frame(index);
    session_->run(FrameView(frame.input()).checked());
    for (auto* device : cell_.devices) device->set_clocks(Clocks::on);
    const ranges::ProfilerRange stretch(frame_names_[index].c_str());
    const auto result = session_->run(FrameView(frame.input()).checked());
    std::vector<Trace> traces;
    for (auto* device : cell_.devices) traces.push_back(device->finish());
    for (auto* device : cell_.devices) device->set_clocks(Clocks::off);
    return traces;
}

std::map<std::string_view, std::uint64_t> Replays::counted() {
    std::map<std::string_view, std::uint64_t> work;
    session_->reset();
    session_->count_work(true);
    for (std::size_t i = 0; i < range_.size(); ++i) {
        const auto result = session_->run(FrameView(next_frame(i).input()).checked());
        for (const auto& counter : cell_.algorithm->counters()) {
            const auto found = result.work.find(counter.name);
            if (found == result.work.end()) continue;
            auto& total = work[counter.name];
            total = counter.total == Counter::Total::sum ? total + found->second : found->second;
        }
    }
    session_->count_work(false);
    return work;
}

} // namespace tandem
