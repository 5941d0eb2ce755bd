// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/frames.h"
#include "harness/plans/cells.h"

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace tandem {

/// Replays frames with the candidates of a cell, timed like samples. Sessions are kept while they use at most
/// a quarter of a device's memory, because a session that lacks memory runs in batches. Freed sessions are
/// prepared again when needed. With ranks, calls are collective: rank 0 decides what depends on clocks or on
/// the memory of its device.
class Trials {
public:
    /// Replays use the first `frames` frames of the range. The first three arguments must outlive this
    /// object. Replays end with Interrupted before a frame where `stop` returns true.
    Trials(
        std::span<const Cell> candidates, const Scene& scene, const FrameRange& range, std::size_t frames,
        std::function<bool()> stop = [] { return false; });

    /// Makes the candidate's session, if it is missing, and replays the frames once, so that kernels are
    /// compiled and buffers grow. Returns false when the candidate failed, in this call or earlier.
    bool prepare(std::size_t candidate);
    /// Nanoseconds of one replay. None when the candidate failed: a device failed, the settings do not fit
    /// the scene, or the number of pairs (of contacts, if candidates may differ in k) differs from the first
    /// candidate's.
    std::optional<std::int64_t> replay(std::size_t candidate);
    /// Frees the candidate's session.
    void drop(std::size_t candidate) { sessions_[candidate].reset(); }

    /// Candidate pairs of all frames by the first candidate; 0 before a candidate was prepared.
    std::uint64_t pairs() const { return pairs_.value_or(0); }
    /// The failure in one line; empty when the candidate did not fail.
    const std::string& failure(std::size_t candidate) const { return failures_[candidate]; }
    double measured_seconds() const { return measured_; }
    double preparing_seconds() const { return preparing_; }

private:
    void make_session(std::size_t candidate);
    void make_session_in_free_memory(std::size_t candidate);
    bool is_short_of_memory() const;
    void free_sessions();
    /// Seconds since `begin`, by the clock of rank 0.
    double seconds_since(std::chrono::steady_clock::time_point begin) const;
    /// Nanoseconds of the frames only. Throws DeviceError.
    std::int64_t run(std::size_t candidate);

    std::span<const Cell> candidates_;
    RankTeam* const team_; ///< null: one process
    const Scene& scene_;
    const FrameRange& range_;
    std::size_t frames_;
    std::function<bool()> stop_;
    std::vector<std::unique_ptr<Session>> sessions_;
    std::vector<std::string> failures_;
    const bool compares_contacts_;
    std::optional<std::uint64_t> pairs_, contacts_; ///< of all frames, by the first candidate
    double measured_ = 0, preparing_ = 0;
};

} // namespace tandem
