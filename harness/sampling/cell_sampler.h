// SPDX-License-Identifier: MIT
#pragma once

#include "harness/accuracy/truths.h"
#include "harness/references.h"
#include "harness/sampling/replays.h"

#include <functional>

namespace tandem {

/// How answers are looked at, and what else a cell is replayed for.
struct CheckOptions {
    bool check = true;        ///< against the reference
    bool count_work = true;   ///< by kernels that count
    Truths* truths = nullptr; ///< of the same scene and frames; null: no comparison with the truth
    std::function<void(std::string_view)> progress = [](std::string_view) {};
};

/// One cell as it is measured: a check of every answer, then rounds. A round prepares a session anew, so that
/// the luck of an allocation is part of the noise; warms up until replays stop falling; takes samples, each
/// held against the checked answers; and one replay with a clock around every command.
/// Every function may throw DeviceError; what was measured before stays.
class CellSampler {
public:
    /// All must outlive this.
    CellSampler(const Cell& cell, const Scene& scene, const FrameRange& range, References& references);

    /// The first session: every answer against the reference and the truth. The first round goes on with it.
    void check(const CheckOptions& options);
    /// A round of so many samples, which may be 0.
    void round(std::size_t samples);
    /// With a session of its own, which has the kernels that count.
    void count_work();
    /// Frees the session, which the next round prepares anew.
    void release() { replays_.reset(); }

    const Cell& cell() const { return cell_; }
    const Measurement& measurement() const { return out_; }
    /// Nanoseconds that its rounds have taken, with their preparations.
    std::int64_t spent_ns() const { return spent_; }
    /// How many samples of it take a quarter of the time that a preparation does; 1 to 32.
    std::size_t samples_a_round() const;
    /// Of seconds, so that every sample had better not have its own.
    bool preparation_is_long() const { return prepare_ns_ > 2'000'000'000; }

private:
    void begin_session();
    void warm_up();
    void sample();
    bool makes_contacts() const;
    void compare(const ReferenceAnswer& expected, const FrameResult& result, const Digest& digest,
                 const Digest& contacts);
    void look(std::size_t index, const FrameResult& result, const CheckOptions& options);
    void add_errors(Truths& truths, std::size_t index, const FrameResult& result, const Digest& digest,
                    const Digest& contacts, const Report& report);
    void add_counts(const FrameResult& result);
    void take_kernels();

    const Cell& cell_;
    const Scene& scene_;
    const FrameRange& range_;
    References& references_;
    std::string name_;
    Measurement out_;
    std::optional<Replays> replays_;
    ConditionReader conditions_;
    Geometry geometry_;
    std::vector<Digest> digests_;             ///< [frame] of the checking replay
    std::int64_t last_replay_ns_ = -1;        ///< of the session; -1 before its first
    std::int64_t warmed_ns_ = 0;              ///< that the session has replayed when warming up begins
    std::int64_t prepare_ns_ = 0, spent_ = 0; ///< of the last session; of all rounds
    std::uint32_t round_ = 0;
};

} // namespace tandem
