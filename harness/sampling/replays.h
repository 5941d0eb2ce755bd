// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranges.h"
#include "harness/frames/frames.h"
#include "harness/program/interrupt.h"
#include "harness/sampling/measurement.h"

#include <functional>

namespace tandem {

/// Replays the frames with one session of a cell. Every function may throw DeviceError. For a cell of several
/// ranks every function is collective, and so are the functions of results that `visit` calls.
class Replays {
public:
    /// Prepares the session and waits for the end. The first three arguments must outlive this object.
    /// `stop` is called before each frame: where it returns true, replays throw Interrupted, and the session
    /// is not used any more. For a cell of several ranks it is collective.
    Replays(
        const Cell& cell, const Scene& scene, const FrameRange& range,
        std::function<bool()> stop = [] { return false; });

    /// Duration of the upload of static data and of new compilations.
    std::int64_t prepare_ns() const { return prepare_ns_; }
    const Settings& settings() const { return session_->settings(); }

    /// Runs every frame, times only its span, and passes each result to `visit` outside that span. A frame
    /// that the range does not store is generated outside the span and the frame's profiler range, but inside
    /// the cell's profiler range, as is `visit`. Generating a frame cools the caches and leaves the devices
    /// idle for longer.
    template<class Visit>
    TimedReplay timed(const Visit& visit) {
        const ranges::ProfilerRange cell(name_.c_str());
        session_->reset();
        TimedReplay replay;
        for (std::size_t i = 0; i < range_.size(); ++i) {
            const auto frame = next_frame(i);
            const ranges::ProfilerRange stretch(frame_names_[i].c_str());
            const auto begin = std::chrono::steady_clock::now();
            const auto result = session_->run(FrameView(frame.input()).checked());
            replay.frame_ns.push_back(since(begin));
            replay.add(result);
            visit(i, result);
        }
        return replay;
    }
    /// Runs every frame with a clock around every command.
    InstrumentedReplay instrumented();
    /// The timed commands of frame number `index` of the range, by device. Frames up to and including it run
    /// first without clocks.
    std::vector<Trace> traced(std::size_t index);
    /// Values of the algorithm's counters over the frames. Counting uses other kernels, which are not timed:
    /// do not use the session for times afterwards.
    std::map<std::string_view, std::uint64_t> counted();

    /// Calls so far that submitted work to the devices.
    std::uint64_t submissions() const;

private:
    /// Throws Interrupted.
    FrameState next_frame(std::size_t index);
    void wait();

    const Cell& cell_;
    const FrameRange& range_;
    std::function<bool()> stop_;
    std::string name_;                     ///< of the cell, for profilers
    std::vector<std::string> frame_names_; ///< by frame; empty texts without a profiler
    std::unique_ptr<Session> session_;
    std::int64_t prepare_ns_ = 0;
};

} // namespace tandem
