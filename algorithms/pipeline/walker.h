// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/queued_stage.h"
#include "algorithms/answer/status.h"
#include "algorithms/bodies/body_pair.h"
#include "algorithms/kernels/counter.h"

#include <map>
#include <optional>

namespace tandem {

/// Build options of a walk's kernels.
struct WalkBuild {
    Output output = Output::pairs;
    PairLayout pair_layout = PairLayout::slots;
    bool counting = false; ///< count work; never timed
    bool windowed = false; ///< emit pairs of the items in the status' window only (emit.clh)
    bool self = false;     ///< body pairs may be of a body with itself

    bool operator==(const WalkBuild&) const = default;
    /// Adds its defines to those of a hierarchy.
    void add_to(Defines& defines) const;
};

/// Callback of a data path between the launches of one walk.
class LaunchHook {
public:
    virtual ~LaunchHook() = default;
    /// Called after a part of the walk, which may have found pairs.
    virtual void part_walked() = 0;
};

/// Input and output of a walk: body pairs on the device, and the buffers of the answer.
struct WalkTask {
    const Buffer& body_pairs;          ///< rows of two words; the status has their number
    std::uint32_t pair_capacity = 0;   ///< capacity of `body_pairs`, in rows
    bool searched = false;             ///< the device finds the pairs; the host does not have their number
    bool complete = false;             ///< no pair is missing of those whose volumes overlap
    std::span<const BodyPair> on_host; ///< the pairs; empty if the device finds them
    const AnswerBuffers& answer;
    Status& status;
    LaunchHook* launch_hook = nullptr; ///< null: none

    /// The number of body pairs, or an upper bound if the device finds them.
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

    /// Compiles the kernels, or reuses compiled ones. Must be called before the first launch.
    void compile(const WalkBuild& build) { do_compile(build); }
    /// Enqueues the walk. If its schedule needs the host, runs it. Throws DeviceError.
    void launch(const WalkTask& task) { do_launch(task); }
    /// Grows the walker's own buffers if the last walk overflowed them. Returns true if the walk must run
    /// again. Throws OutOfMemory.
    bool grow(const Status& status) { return do_grow(status); }
    /// The limits of the walker's own buffers, for a frame that the host does not wait for; nullopt if the
    /// host takes part in the walk.
    std::optional<std::vector<Limit>> limits() const { return do_limits(); }
    /// Clears state that is carried from walk to walk; a walker without state has none.
    void reset() { do_reset(); }
    /// Adds the counts of a counting walk, by the names of Traversal::counters().
    void report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const {
        do_report(status, work);
    }

private:
    virtual void do_compile(const WalkBuild& build) = 0;
    virtual void do_launch(const WalkTask& task) = 0;
    virtual bool do_grow(const Status& status) = 0;
    virtual std::optional<std::vector<Limit>> do_limits() const { return std::nullopt; }
    virtual void do_reset() {}
    virtual void do_report(const Status& status, std::map<std::string_view, std::uint64_t>& work) const = 0;
};

} // namespace tandem
