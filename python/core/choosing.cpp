// SPDX-License-Identifier: MIT
#include "python/core/choosing.h"

#include "harness/plans/choosing/race.h"
#include "harness/sampling/statistics.h"

#include <chrono>

namespace tandem::python {

Choosing choose(std::span<const Cell> candidates, const Scene& scene,
                const std::function<FrameResult(Session&)>& frame, double seconds) {
    std::vector<std::unique_ptr<Session>> sessions(candidates.size());
    const auto prepare = [&](std::size_t i) {
        const auto& cell = candidates[i];
        sessions[i] = cell.algorithm->prepare(cell.devices, scene, cell.settings);
    };
    const auto replay = [&](std::size_t i) -> Replayed {
        const auto begin = std::chrono::steady_clock::now();
        const auto result = frame(*sessions[i]);
        const std::chrono::nanoseconds time = std::chrono::steady_clock::now() - begin;
        return {time.count(), result.count, result.contacts};
    };
    Race race(candidates,
              {.prepare = prepare, .replay = replay, .free = [&](std::size_t i) { sessions[i].reset(); }});
    const auto ranking = race.run(seconds);
    if (ranking.empty()) throw InputError(race.failure(0));
    const auto best = ranking.front();
    if (!sessions[best]) prepare(best);
    Choosing chosen{std::move(sessions[best]), candidates[best].algorithm, {}};
    for (const auto i : ranking)
        chosen.trials.push_back({std::string(candidates[i].algorithm->name()), changes(candidates[i]),
                                 1e-9 * median(race.times(i))});
    return chosen;
}

} // namespace tandem::python
