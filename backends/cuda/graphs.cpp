// SPDX-License-Identifier: MIT
#include "backends/cuda/graphs.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::cuda {

namespace {

/// CU_STREAM_CAPTURE_MODE_RELAXED: other threads may use their contexts freely during a capture.
constexpr int relaxed = 2;

Graphs::Failure enqueue(const Driver& driver, std::span<const Command> commands, Stream stream) {
    for (const auto& command : commands)
        if (const auto code = command.submit(driver, stream); code != 0)
            return {code, command.call(), command.describe()};
    return {};
}

} // namespace

Graphs::Known* Graphs::find(std::span<const Command> commands) {
    const auto found = std::ranges::find_if(
        known_, [&](const Known& k) { return std::ranges::equal(k.commands, commands); });
    return found != known_.end() ? &*found : nullptr;
}

/// Replaces the least recently used sequence when there are too many.
Graphs::Failure Graphs::remember(std::span<const Command> commands, Stream stream) {
    if (known_.size() < max_sequences) {
        known_.emplace_back();
    } else {
        const auto oldest = std::ranges::min_element(known_, {}, &Known::used);
        std::iter_swap(oldest, known_.end() - 1);
    }
    auto& known = known_.back();
    if (known.graph != nullptr) {
        if (const auto code = driver_.cuStreamSynchronize(stream); code != 0)
            return {code, "cuStreamSynchronize", "waiting before a graph is destroyed"};
        driver_.cuGraphExecDestroy(std::exchange(known.graph, nullptr));
    }
    known.commands.assign(commands.begin(), commands.end());
    known.used = now_;
    return {};
}

Graphs::Failure Graphs::capture(Known& known, Stream stream) {
    const auto what = [&] { return fmt::format("capturing {} commands", known.commands.size()); };
    if (const auto code = driver_.cuStreamBeginCapture_v2(stream, relaxed); code != 0)
        return {code, "cuStreamBeginCapture", what()};
    auto failure = enqueue(driver_, known.commands, stream);
    Graph graph = nullptr; // always ended, or the stream stays unusable
    const auto ended = driver_.cuStreamEndCapture(stream, &graph);
    if (failure.code == 0 && ended != 0) failure = {ended, "cuStreamEndCapture", what()};
    if (failure.code == 0)
        if (const auto code = driver_.cuGraphInstantiateWithFlags(&known.graph, graph, 0); code != 0)
            failure = {code, "cuGraphInstantiate", what()};
    if (graph != nullptr) driver_.cuGraphDestroy(graph);
    return failure;
}

Graphs::Failure Graphs::submit(std::span<const Command> commands, Stream stream, std::uint64_t& submissions) {
    if (commands.size() == 1) { // a graph gains nothing
        ++submissions;
        return enqueue(driver_, commands, stream);
    }
    ++now_;
    auto* known = find(commands);
    if (known == nullptr) {
        if (auto failure = remember(commands, stream); failure.code != 0) return failure;
        submissions += commands.size();
        return enqueue(driver_, commands, stream);
    }
    known->used = now_;
    if (known->graph == nullptr) {
        // The stored labels may be invalid; equal commands have equal labels.
        known->commands.assign(commands.begin(), commands.end());
        if (auto failure = capture(*known, stream); failure.code != 0) return failure;
    }
    ++submissions;
    if (const auto code = driver_.cuGraphLaunch(known->graph, stream); code != 0)
        return {code, "cuGraphLaunch", fmt::format("submitting {} commands as one", commands.size())};
    return {};
}

void Graphs::drop() {
    for (const auto& known : known_)
        if (known.graph != nullptr) driver_.cuGraphExecDestroy(known.graph);
    known_.clear();
}

} // namespace tandem::cuda
