// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/answers.h"
#include "algorithms/answer/status.h"

#include <map>

namespace tandem {

/// How a walk's kernels are built.
struct WalkBuild {
    Output output = Output::pairs;
    PairLayout pair_layout = PairLayout::slots;
    bool counting = false; ///< count work; never timed
    bool windowed = false; ///< answer for the items of the status' window only (emit.clh)

    bool operator==(const WalkBuild&) const = default;
    /// Its defines, added to those of a hierarchy.
    void add_to(Defines& defines) const;
};

/// What a data path does between the launches of one walk, if anything.
class LaunchHook {
public:
    virtual ~LaunchHook() = default;
    /// A part of the walk has ended and may have found pairs.
    virtual void part_walked() = 0;
};

/// What a walk works on: body pairs on the device, and where answers go.
struct WalkTask {
    const Buffer& body_pairs;          ///< rows of two words; the status has their number
    std::uint32_t pair_capacity = 0;   ///< rows there is room for: their number is at most that
    bool searched = false;             ///< the device has found them, and the host does not know their number
    std::span<const BodyPair> on_host; ///< the pairs themselves unless the device has found them
    const AnswerBuffers& answer;
    Status& status;
    LaunchHook* launch_hook = nullptr; ///< of data paths that have one

    /// Their number, or the most it can be.
    std::uint32_t most_pairs() const {
        return searched ? pair_capacity : static_cast<std::uint32_t>(on_host.size());
    }
};

/// Walks hierarchies in tandem, from body pairs to candidate pairs.
class Walker {
public:
    virtual ~Walker() = default;
    Walker() = default;
    Walker(const Walker&) = delete;
    Walker& operator=(const Walker&) = delete;

    /// Compiles, or takes what has been compiled. Comes before the first launch.
    void compile(const WalkBuild& build) { do_compile(build); }
    /// Enqueues the walk; one whose schedule needs the host runs it. Throws DeviceError.
    void launch(const WalkTask& task) { do_launch(task); }
    /// Grows own buffers that a walk has found too small; true when it has to run again. Throws OutOfMemory.
    bool grow(const Status& status) { return do_grow(status); }
    /// Adds what a counting walk counted, by the names of Traversal::counters().
    void report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
        do_report(status, work);
    }

private:
    virtual void do_compile(const WalkBuild& build) = 0;
    virtual void do_launch(const WalkTask& task) = 0;
    virtual bool do_grow(const Status& status) = 0;
    virtual void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const = 0;
};

/// Counters of every walk that emits by emit.clh.
namespace counters {
inline constexpr Counter bvtt_nodes{"bvtt_nodes", "node pairs", "node pairs tested"};
inline constexpr Counter seeds{"seeds", "node pairs", "node pairs that walks started from"};
} // namespace counters

} // namespace tandem
