// SPDX-License-Identifier: MIT
// The results of measuring a cell.
#pragma once

#include "algorithms/answer/frame_result.h"
#include "algorithms/bodies/cost.h"
#include "harness/verify/accuracy/answer_errors.h"
#include "harness/verify/deep_contact.h"
#include "harness/verify/flattened.h"
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

/// One sample a stage, in the order of stage_names.
using StageSamples = std::array<StageSample, stage_names.size()>;

/// Sums over the commands of a trace; device times that were not measured count as 0.
StageSamples by_stage(const Trace& trace);

/// Nanoseconds since `begin`.
std::int64_t since(std::chrono::steady_clock::time_point begin);

/// Sums of one kernel over a replay.
struct KernelSample {
    std::int64_t device_ns = 0; ///< times that were not measured count as 0
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
    Stage stage = Stage::preprocess; ///< whose times include it
};

/// Sum of one phase over a replay.
struct PhaseSample {
    std::int64_t host_ns = 0;
};

/// A sample: a replay that times only the whole span of each frame.
struct TimedReplay {
    std::uint32_t round = 0;
    std::vector<std::int64_t> frame_ns;
    // Only for a session on several devices; sums over the frames.
    std::vector<std::int64_t> shared_ns = {}; ///< [device] time at work
    std::int64_t longest_ns = 0;              ///< the longest device time of each frame
    std::uint64_t repartitions = 0;           ///< frames before which the bodies were repartitioned
    std::uint64_t rebuilds = 0;               ///< trees built because none was kept, on every device

    std::int64_t total_ns() const;
    /// Adds the work that a frame's result has counted.
    void add(const FrameResult& result);
    /// Ratio of the longest device time to the mean, 1 for equal times; empty for one device.
    std::optional<double> imbalance() const;
};

/// A replay with a clock around every command. It is slower than a sample; the headline does not use it.
struct InstrumentedReplay {
    std::uint32_t round = 0;
    std::vector<std::int64_t> frame_ns;                   ///< host spans
    std::vector<std::int64_t> span_ns;                    ///< by frame, first begin to last end; -1: unknown
    std::vector<StageSamples> stages;                     ///< by frame
    std::vector<StageSamples> by_device = {};             ///< sums over the frames
    std::map<std::string, KernelSample> kernels = {};     ///< by entry point
    std::map<std::string, HostWorkSample> host_work = {}; ///< by name
    std::map<std::string, PhaseSample> phases = {};       ///< by name
    std::vector<std::string> clocks = {};                 ///< by device: the clock of its times

    /// Sums over the frames.
    StageSamples totals() const;
};

/// The condition of the machine before and after the samples of a round.
struct RoundConditions {
    std::uint32_t round = 0;
    Condition before, after;

    /// Why the round is doubtful; empty when it is not.
    std::optional<std::string> disturbed() const { return disturbance(before, after); }
};

/// Comparison of the cell's answers with the reference.
struct Agreement {
    std::uint64_t frames = 0; ///< compared frames
    std::uint64_t missing = 0, extra = 0;
    std::uint64_t contact_frames_wrong = 0; ///< frames whose contacts differ in any bit
    Digest digest;                          ///< sums over the frames
    Digest contact_digest;

    bool ok() const { return missing == 0 && extra == 0 && contact_frames_wrong == 0; }
};

/// All results of one cell.
struct Measurement {
    Settings settings; ///< as the device used them
    std::vector<TimedReplay> samples;
    std::vector<InstrumentedReplay> breakdowns;
    std::vector<RoundConditions> conditions; ///< of every round with samples
    std::vector<std::uint32_t> continued;    ///< first rounds of later runs that resumed the cell
    std::vector<std::uint64_t> body_pairs, candidate_pairs, contacts; ///< [frame]
    /// [frame] left out by broad=sphere_boxes, as the reference counts; empty with other broad phases.
    std::vector<std::uint64_t> dropped_body_pairs, dropped_candidate_pairs;
    std::uint64_t walked_tetrahedra = 0;         ///< summed over the bodies
    FrameCounts counts;                          ///< of the checking replay, over the frames
    std::vector<std::vector<DeviceWork>> shared; ///< [frame][device] of the last sample; empty on one device
    std::uint64_t submissions = 0;               ///< calls that submitted work, in the last sample
    std::map<std::string_view, std::uint64_t> work; ///< by counter, over the frames; empty when not counted
    Agreement agreement;
    std::optional<AnswerErrors> errors;      ///< against the exact truth; empty when not requested
    std::optional<DeepContact> deep_contact; ///< of the first frame with any; empty when not checked
    Flattened flattened;                     ///< in the first frame
    std::vector<KernelFacts> kernels;
    std::int64_t prepare_ns = 0; ///< of the first session, with compilation; not part of any sample
    std::size_t device_bytes = 0;

    /// Time and round of each sample, as arguments of summarise().
    std::vector<std::int64_t> totals() const;
    std::vector<std::uint32_t> rounds() const;
    std::size_t round_count() const; ///< rounds with samples
};

/// Median nanoseconds of a sample; of an instrumented replay for a cell without samples (tandem check).
double median_ns(const Measurement& m);

/// The mean frame of a measurement. The caller adds the data that its pairs touch.
FrameFacts mean_frame(const Measurement& m);

} // namespace tandem
