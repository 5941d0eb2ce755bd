// SPDX-License-Identifier: MIT
#include "python/core/choosing.h"

#include "harness/plans/choosing/candidates.h"
#include "harness/plans/choosing/search.h"
#include "harness/sampling/statistics.h"

#include <chrono>
#include <fmt/format.h>

namespace tandem::python {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double preparing_per_measuring = 6; ///< equal to the ratio of `tandem run`

std::int64_t nanoseconds_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

/// The candidates' sessions, and the time spent on them.
class Trials {
public:
    Trials(std::span<const Cell> candidates, const Scene& scene,
           const std::function<FrameResult(Session&)>& frame)
        : candidates_(candidates), scene_(scene), frame_(frame), sessions_(candidates.size()) {}

    std::optional<std::int64_t> replay(std::size_t i);
    void drop(std::size_t i) { sessions_[i].reset(); }
    std::unique_ptr<Session> take(std::size_t i) { return std::move(sessions_[i]); }
    std::unique_ptr<Session> prepared(std::size_t i) const {
        return candidates_[i].algorithm->prepare(candidates_[i].devices, scene_, candidates_[i].settings);
    }
    double measured() const { return measured_; }
    double preparing() const { return preparing_; }
    const std::string& first_failure() const { return first_failure_; }

private:
    void prepare(std::size_t i);

    std::span<const Cell> candidates_;
    const Scene& scene_;
    const std::function<FrameResult(Session&)>& frame_;
    std::vector<std::unique_ptr<Session>> sessions_;
    std::optional<std::uint64_t> answer_; ///< number of pairs or contacts of the first candidate
    std::string first_failure_;
    double measured_ = 0, preparing_ = 0;
};

/// Includes the first frame, in which kernels compile and buffers grow.
void Trials::prepare(std::size_t i) {
    if (sessions_[i]) return;
    const auto begin = Clock::now();
    sessions_[i] = prepared(i);
    const auto result = frame_(*sessions_[i]);
    const bool compares_contacts = may_differ_in_k(candidates_[i]);
    const auto count = compares_contacts ? result.contacts : result.count;
    preparing_ += static_cast<double>(nanoseconds_since(begin)) * 1e-9;
    if (answer_.value_or(count) != count)
        throw DeviceError(fmt::format("{} finds {} {}, the first candidate {}", describe(candidates_[i]),
                                      count, compares_contacts ? "contacts" : "candidate pairs", *answer_));
    answer_ = count;
}

std::optional<std::int64_t> Trials::replay(std::size_t i) {
    try {
        prepare(i);
        const auto begin = Clock::now();
        frame_(*sessions_[i]);
        const auto time = nanoseconds_since(begin);
        measured_ += static_cast<double>(time) * 1e-9;
        return time;
    } catch (const DeviceError& error) {
        if (first_failure_.empty()) first_failure_ = error.what();
    } catch (const InputError& error) {
        if (first_failure_.empty()) first_failure_ = error.what();
    }
    drop(i);
    return std::nullopt;
}

} // namespace

Choosing choose(std::span<const Cell> candidates, const Scene& scene,
                const std::function<FrameResult(Session&)>& frame, double seconds) {
    Trials trials(candidates, scene, frame);
    const auto found = search(candidates.size(),
                              {.replay = [&](std::size_t i) { return trials.replay(i); },
                               .measured = [&] { return trials.measured(); },
                               .preparing = [&] { return trials.preparing(); },
                               .drop = [&](std::size_t i) { trials.drop(i); }},
                              {seconds, preparing_per_measuring * seconds});
    if (found.ranking.empty()) throw InputError(trials.first_failure());
    Choosing chosen;
    const auto best = found.ranking.front();
    chosen.session = trials.take(best);
    if (!chosen.session) chosen.session = trials.prepared(best);
    chosen.algorithm = candidates[best].algorithm;
    for (const auto i : found.ranking)
        chosen.trials.push_back({std::string(candidates[i].algorithm->name()), changes(candidates[i]),
                                 1e-9 * median(found.replays[i])});
    return chosen;
}

} // namespace tandem::python
