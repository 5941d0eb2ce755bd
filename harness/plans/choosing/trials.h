// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/frames.h"
#include "harness/plans/cells.h"

#include <optional>
#include <string>

namespace tandem {

/// Replays frames with the candidates of a cell, timed as samples are. Sessions stay as long as they take no
/// more than a quarter of a device's memory, since what is short of it runs in batches; those that had to go
/// are prepared again.
class Trials {
public:
    /// The first `frames` frames of the range. All must outlive this.
    Trials(std::span<const Cell> candidates, const Scene& scene, const FrameRange& range, std::size_t frames);

    /// Makes the candidate's session, unless it is there, and replays the frames once: kernels compile and
    /// buffers grow. False when it failed, now or before.
    bool prepare(std::size_t candidate);
    /// Nanoseconds of one replay; none when the candidate failed: a device did, its settings do not fit the
    /// scene, or it found another number of pairs than the first.
    std::optional<std::int64_t> replay(std::size_t candidate);
    /// Frees what its session holds.
    void drop(std::size_t candidate) { sessions_[candidate].reset(); }

    /// Candidate pairs of all frames, once one was prepared.
    std::uint64_t pairs() const { return pairs_.value_or(0); }
    /// One line; empty when it did not fail.
    const std::string& failure(std::size_t candidate) const { return failures_[candidate]; }
    double measured_seconds() const { return measured_; }
    double preparing_seconds() const { return preparing_; }

private:
    void make_session(std::size_t candidate);
    void make_room_and_session(std::size_t candidate);
    void free_sessions();
    /// Nanoseconds of the frames and nothing else. Throws DeviceError.
    std::int64_t run(std::size_t candidate);

    std::span<const Cell> candidates_;
    const Scene& scene_;
    const FrameRange& range_;
    std::size_t frames_;
    std::vector<std::unique_ptr<Session>> sessions_;
    std::vector<std::string> failures_;
    std::optional<std::uint64_t> pairs_;
    double measured_ = 0, preparing_ = 0;
};

} // namespace tandem
