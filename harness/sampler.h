// SPDX-License-Identifier: MIT
#pragma once

#include "harness/accuracy/truths.h"
#include "harness/flaws.h"
#include "harness/plan.h"
#include "harness/reference.h"

#include <chrono>
#include <functional>
#include <optional>

namespace tandem {

/// Frames FIRST..LAST of a scene, made before anything is measured.
struct FrameRange {
    std::size_t first = 0;
    std::size_t last = 0;
    std::vector<Frame> frames;
    Flaws flaws{}; ///< of these frames, and how they were handled
};

/// Throws InputError when the scene has no such frames, which says why.
void check_frames(const Scene& scene, std::size_t first, std::size_t last);

/// The frames, once checked.
FrameRange make_frames(const Scene& scene, std::size_t first, std::size_t last);

/// Answers of the reference per frame, computed once for each geometry.
class References {
public:
    References(const Scene& scene, const FrameRange& range) : scene_(scene), range_(range) {}

    /// Of frame number `index` of the range; serial host code that may take minutes on a large scene.
    const ReferenceAnswer& answer(const Geometry& geometry, const ContactSettings& contacts,
                                  std::size_t index);

private:
    const Scene& scene_;
    const FrameRange& range_;
    using Key = std::pair<Geometry, ContactSettings>;
    std::vector<std::pair<Key, std::vector<std::optional<ReferenceAnswer>>>> known_;
};

/// Sums of a stage over one frame of the breakdown run.
struct StageSample {
    std::int64_t device_ns = 0;
    std::int64_t host_ns = 0;
    std::uint64_t launches = 0, waits = 0, bytes = 0;

    StageSample& operator+=(const StageSample& other);
};

/// Nanoseconds since `begin`.
std::int64_t since(std::chrono::steady_clock::time_point begin);

/// By stage, as in stage_names.
using StageSamples = std::array<StageSample, stage_names.size()>;

/// The sums of what ran; device times that were not measured count as 0.
StageSamples by_stage(const Trace& trace);

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
    Settings settings;                               ///< as the device took them
    std::vector<std::vector<std::int64_t>> total_ns; ///< [repeat][frame], nothing but the span timed
    std::vector<StageSamples> stages;                ///< [frame] of the breakdown run
    std::vector<std::int64_t> breakdown_ns;          ///< [frame] span of the breakdown run
    std::vector<std::int64_t> device_span_ns; ///< [frame] first begin to last end; empty when not known
    std::vector<std::uint64_t> body_pairs, candidate_pairs, contacts; ///< [frame]
    std::uint64_t degenerate = 0, rejected = 0, undecided_by_filter = 0, undecided_by_double = 0;
    std::uint64_t retries = 0, batches = 0;         ///< of the checking replay
    std::uint64_t submissions = 0;                  ///< calls that handed devices work, in the last sample
    std::map<std::string_view, std::uint64_t> work; ///< by counter, over the frames; empty when not counted
    Agreement agreement;
    std::optional<AnswerErrors> errors; ///< against the exact truth; none when not asked for
    std::vector<KernelFacts> kernels;
    std::int64_t prepare_ns = 0; ///< upload of static data and compilation; in no sample
    std::size_t device_bytes = 0;
};

struct SampleOptions {
    std::size_t repeat = 3;
    bool check = true;
    bool count_work = true;
    Truths* truths = nullptr; ///< of the same scene and frames; null: no comparison with the truth
    std::function<void(std::string_view)> progress = [](std::string_view) {};
};

/// Prepares the cell; replays the frames once to warm up and check every answer, `repeat` times with only the
/// span of each frame timed (checking the digest after each), once with timestamps on every command, and once
/// with counting kernels.
Measurement measure(const Cell& cell, const Scene& scene, const FrameRange& range, References& references,
                    const SampleOptions& options);

} // namespace tandem
