// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranges.h"
#include "harness/plans/frames.h"
#include "harness/sampling/ranks/rank_team.h"
#include "harness/sampling/measurement.h"

namespace tandem {

/// A session of a cell and the ways to replay the frames with it. Every function may throw DeviceError. Ranks
/// that measure the cell together call each function together, and those of results in `look`.
class Replays {
public:
    /// Prepares the session and waits until it is. All must outlive this.
    Replays(const Cell& cell, const Scene& scene, const FrameRange& range);

    /// Upload of static data, and compilations that were not made before.
    std::int64_t prepare_ns() const { return prepare_ns_; }
    const Settings& settings() const { return session_->settings(); }

    /// Runs every frame, with nothing but its span timed, and hands each result to `look` outside of that
    /// span. So is a frame made that the range does not hold: neither the span nor the profiler's range of
    /// the frame has that, but that of the cell has, as it has `look`. Where frames are made the session's
    /// data is colder in caches, and the devices were idle for longer, than where they are held.
    template<class Look>
    TimedReplay timed(const Look& look) {
        const ranges::ProfilerRange cell(name_.c_str());
        session_->reset();
        TimedReplay replay;
        for (std::size_t i = 0; i < range_.size(); ++i) {
            const auto frame = next_frame(i);
            const ranges::ProfilerRange stretch(frame_names_[i].c_str());
            const auto begin = std::chrono::steady_clock::now();
            const auto result = session_->run(*frame);
            replay.frame_ns.push_back(since(begin));
            replay.add_shared(result);
            look(i, result);
        }
        return replay;
    }
    /// With a clock around every command.
    InstrumentedReplay instrumented();
    /// The commands of frame number `index` of the range on each device, with a clock around them, once the
    /// frames up to it have run without.
    std::vector<Trace> traced(std::size_t index);
    /// By counter of the algorithm, over the frames. The kernels that count are others: what they take is not
    /// measured, and the session is of no use for times afterwards.
    std::map<std::string_view, std::uint64_t> counted();

    /// Calls that handed work to the devices so far.
    std::uint64_t submissions() const;

private:
    std::shared_ptr<const Frame> next_frame(std::size_t index);
    void wait();

    const Cell& cell_;
    const FrameRange& range_;
    std::string name_;                     ///< of the cell, for profilers
    std::vector<std::string> frame_names_; ///< of its frames; empty texts where no profiler looks
    std::unique_ptr<Session> session_;
    std::int64_t prepare_ns_ = 0;
};

} // namespace tandem
