// SPDX-License-Identifier: MIT
// What measuring a cell gives.
#pragma once

#include "harness/verify/accuracy/answer_errors.h"
#include "harness/sampling/conditions.h"
#include "harness/plans/cells.h"

#include <chrono>
#include <map>
#include <optional>

namespace tandem {

/// Sums of a stage, over a frame or over a replay.
struct StageSample {
    std::int64_t device_ns = 0;
    std::int64_t host_ns = 0;
    std::uint64_t launches = 0, waits = 0, bytes = 0;

    StageSample& operator+=(const StageSample& other);
};

/// By stage, as in stage_names.
using StageSamples = std::array<StageSample, stage_names.size()>;

/// The sums of what ran; device times that were not measured count as 0.
StageSamples by_stage(const Trace& trace);

/// Nanoseconds since `begin`.
std::int64_t since(std::chrono::steady_clock::time_point begin);

/// Sums of one kernel over a replay.
struct KernelSample {
    std::int64_t device_ns = 0; ///< those that were not measured count as 0
    std::uint64_t launches = 0;
    Stage stage = Stage::write;   ///< of the last launch, as group_size
    std::uint64_t groups = 0;     ///< of the largest launch
    std::uint32_t group_size = 0; ///< work-items
    KernelFacts facts{};          ///< of the first launch
};

/// Sums of one kind of host work over a replay.
struct HostWorkSample {
    std::int64_t host_ns = 0;
    std::uint64_t times = 0;
    Stage stage = Stage::preprocess; ///< in which it counts as well
};

/// A replay in which nothing but the span of each frame was timed: a sample.
struct TimedReplay {
    std::uint32_t round = 0;
    std::vector<std::int64_t> frame_ns;
    // Of a session on several devices.
    std::vector<std::int64_t> shared_ns = {}; ///< by device: what it was at work, over the frames
    std::int64_t longest_ns = 0;              ///< of the devices, frame by frame, over the frames
    std::uint64_t repartitions = 0;           ///< frames for which bodies were dealt anew

    std::int64_t total_ns() const;
    void add_shared(const FrameResult& result);
    /// The longest of the devices over the mean of all, 1 where all end together; none on one device.
    std::optional<double> imbalance() const;
};

/// A replay with a clock around every command; slower than a sample, so that nothing of it goes into the
/// headline.
struct InstrumentedReplay {
    std::uint32_t round = 0;
    std::vector<std::int64_t> frame_ns;               ///< host spans
    std::vector<std::int64_t> span_ns;                ///< by frame, first begin to last end; -1: not known
    std::vector<StageSamples> stages;                 ///< by frame
    std::vector<StageSamples> by_device = {};         ///< sums over the frames
    std::map<std::string, KernelSample> kernels = {}; ///< by entry point
    std::map<std::string, HostWorkSample> host_work = {}; ///< by name
    std::vector<std::string> clocks = {};                 ///< by device: what took its times

    /// Sums over the frames.
    StageSamples totals() const;
};

/// What the machine was like before and after the samples of a round.
struct RoundConditions {
    std::uint32_t round = 0;
    Condition before, after;

    /// Why the round is doubtful; none where nothing speaks against it.
    std::optional<std::string> disturbed() const { return disturbance(before, after); }
};

/// The cell's answers against the reference.
struct Agreement {
    std::uint64_t frames = 0; ///< compared
    std::uint64_t missing = 0, extra = 0;
    std::uint64_t contact_frames_wrong = 0; ///< frames whose contacts differ in any bit
    Digest digest;                          ///< sums over the frames
    Digest contact_digest;

    bool ok() const { return missing == 0 && extra == 0 && contact_frames_wrong == 0; }
};

/// Everything one cell gave.
struct Measurement {
    Settings settings; ///< as the device took them
    std::vector<TimedReplay> samples;
    std::vector<InstrumentedReplay> breakdowns;
    std::vector<RoundConditions> conditions; ///< of every round with samples
    std::vector<std::uint32_t> continued;    ///< rounds from which on another run of the program went on
    std::vector<std::uint64_t> body_pairs, candidate_pairs, contacts; ///< [frame]
    std::uint64_t degenerate = 0, rejected = 0, undecided_by_filter = 0, undecided_by_double = 0;
    std::uint64_t retries = 0, batches = 0;      ///< of the checking replay
    std::vector<std::vector<DeviceWork>> shared; ///< [frame][device], in the last sample; of several devices
    std::uint64_t submissions = 0;               ///< calls that handed devices work, in the last sample
    std::map<std::string_view, std::uint64_t> work; ///< by counter, over the frames; empty when not counted
    Agreement agreement;
    std::optional<AnswerErrors> errors; ///< against the exact truth; none when not asked for
    std::vector<KernelFacts> kernels;
    std::int64_t prepare_ns = 0; ///< of the first session, its compilations included; in no sample
    std::size_t device_bytes = 0;

    /// Of the samples, and the round of each: what summarise() takes.
    std::vector<std::int64_t> totals() const;
    std::vector<std::uint32_t> rounds() const;
    std::size_t round_count() const; ///< rounds with samples
};

/// Median nanoseconds of a replay; of a cell without samples (tandem check) that of its instrumented ones.
double median_ns(const Measurement& m);

} // namespace tandem
