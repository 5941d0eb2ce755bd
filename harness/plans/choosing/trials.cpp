// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/trials.h"

#include "harness/plans/choosing/candidates.h"
#include "harness/sampling/interrupt.h"
#include "harness/sampling/measurement.h"
#include "harness/sampling/ranks/rank_team.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;

bool is_crowded(const Device& device) {
    const auto capacity = std::min<std::uint64_t>(device.info().global_bytes, device.memory_limit());
    return device.bytes_allocated() > capacity / 4;
}

/// Sum over the ranks of the team.
std::uint64_t summed(RankTeam* team, std::uint64_t own) {
    if (team == nullptr) return own;
    std::uint64_t sum = 0;
    for (const auto& bytes : team->gather(std::as_bytes(std::span(&own, 1))))
        sum += MessageReader(bytes).read<std::uint64_t>();
    return sum;
}

/// Throws DeviceError unless the number equals the first candidate's.
void check_equal(std::optional<std::uint64_t>& first, std::uint64_t own, std::string_view what) {
    if (first.value_or(own) != own)
        throw DeviceError(fmt::format("found {} {}, the first candidate {}", own, what, *first));
    first = own;
}

/// Candidate pairs of a frame on all devices and ranks.
std::uint64_t pairs_of(const FrameResult& result, const RankTeam* team) {
    if (team == nullptr) return result.count;
    std::uint64_t pairs = 0;
    for (const auto& work : result.shared) pairs += work.pairs;
    return pairs;
}

} // namespace

Trials::Trials(std::span<const Cell> candidates, const Scene& scene, const FrameRange& range,
               std::size_t frames, std::function<bool()> stop)
    : candidates_(candidates),
      team_(candidates.front().team),
      scene_(scene),
      range_(range),
      frames_(frames),
      stop_(std::move(stop)),
      sessions_(candidates.size()),
      failures_(candidates.size()),
      compares_contacts_(may_differ_in_k(candidates.front())) {
    for (auto* device : candidates.front().devices) device->set_clocks(Clocks::off);
}

void Trials::free_sessions() {
    for (auto& session : sessions_) session.reset();
}

void Trials::make_session(std::size_t candidate) {
    const auto& cell = candidates_[candidate];
    sessions_[candidate] = prepare_session(cell, scene_);
    run(candidate);
}

bool Trials::is_short_of_memory() const {
    const auto& devices = candidates_.front().devices;
    return decided(team_,
                   std::ranges::any_of(devices, [](const auto* device) { return is_crowded(*device); }));
}

double Trials::seconds_since(Clock::time_point begin) const {
    return decided(team_, static_cast<double>(since(begin)) * 1e-9);
}

/// Frees the other sessions first when device memory is short.
void Trials::make_session_in_free_memory(std::size_t candidate) {
    if (is_short_of_memory()) free_sessions();
    try {
        make_session(candidate);
    } catch (const OutOfMemory&) {
        free_sessions();
        make_session(candidate);
    }
}

std::int64_t Trials::run(std::size_t candidate) {
    auto& session = *sessions_[candidate];
    session.reset();
    std::int64_t sum = 0;
    std::uint64_t pairs = 0, contacts = 0;
    for (std::size_t i = 0; i < frames_; ++i) {
        if (decided(team_, stop_())) throw Interrupted();
        const auto frame = range_.state(i, session.settings()[parameters::motion]);
        for (auto* device : candidates_[candidate].devices) device->finish();
        const auto begin = Clock::now();
        const auto result = session.run_unchecked(frame.input());
        sum += since(begin);
        pairs += pairs_of(result, team_);
        contacts += result.contacts;
    }
    if (compares_contacts_)
        check_equal(contacts_, summed(team_, contacts), "contacts");
    else
        check_equal(pairs_, pairs, "candidate pairs");
    pairs_ = pairs_.value_or(pairs);
    return decided(team_, sum);
}

bool Trials::prepare(std::size_t candidate) {
    if (!failures_[candidate].empty()) return false;
    if (sessions_[candidate]) return true;
    const auto begin = Clock::now();
    try {
        make_session_in_free_memory(candidate);
    } catch (const DeviceError& error) {
        failures_[candidate] = error.what();
    } catch (const InputError& error) {
        failures_[candidate] = error.what();
    }
    if (!failures_[candidate].empty()) drop(candidate);
    preparing_ += seconds_since(begin);
    return sessions_[candidate] != nullptr;
}

std::optional<std::int64_t> Trials::replay(std::size_t candidate) {
    if (!prepare(candidate)) return std::nullopt;
    try {
        const auto time = run(candidate);
        measured_ += static_cast<double>(time) * 1e-9;
        return time;
    } catch (const DeviceError& error) {
        failures_[candidate] = error.what();
    }
    drop(candidate);
    return std::nullopt;
}

} // namespace tandem
