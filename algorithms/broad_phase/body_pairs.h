// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/status.h"
#include "algorithms/broad_phase/broad.h"
#include "algorithms/broad_phase/broad_stage.h"
#include "algorithms/stages.h"

#include <memory>
#include <optional>

namespace tandem {

/// A frame's body pairs on a device: found there or by the host, as setting broad says, or given.
class BodyPairs {
public:
    /// `writes`: whether an upload of pairs is waited for. What is given must outlive this.
    BodyPairs(const BuildContext& ground, const Hierarchy& hierarchy, Status::Writes writes);

    /// The next launches are of `frame`: uploads the pairs that are given or that the host finds. Throws
    /// InputError for more than kernels number.
    void begin(const Frame& frame, std::optional<std::span<const BodyPair>> given);
    /// The same of a frame that is in the device's memory, after its refit: the device finds the pairs that
    /// are not given, whatever setting broad says.
    void begin_on_device(std::optional<std::span<const BodyPair>> given);
    /// Whether begin() makes the host work for so long that a device had better have something to do
    /// meanwhile.
    bool works_on_host(bool given) const { return !given && (broad_ || !sorted_); }
    /// Whether begin_on_device() has the host wait for where the bodies are.
    bool sorts_on_device(bool given) const { return !given && !sorted_; }
    /// The same with a part of the frame's pairs.
    void begin_part(std::span<const BodyPair> part);
    /// Enqueues the device's search, if it is the device that finds the frame's pairs.
    void launch(const Status& status);
    /// After a launch: makes room for what the device has found; true when the search has to run again.
    /// Throws OutOfMemory.
    bool grow(const Status& status);
    /// The frame's pairs in ascending order, after a launch; they are downloaded when the device has found
    /// them, and found by the host where there is no room for them on the device.
    /// `frame`: null where it is in the device's memory, so that the host cannot: throws OutOfMemory.
    std::vector<BodyPair> list(const Frame* frame, const Status& status) const;
    /// Forgets the order in which bodies stand, unless it is that of a share.
    void reset() { sorted_ = !roles_.empty(); }
    /// From now on finds the pairs of `share`, which has them all where the host does not tell otherwise.
    void take(const Subdomain& share);

    /// Whether it is the device that finds the pairs at hand.
    bool searched() const { return searches_; }
    /// The pairs at hand where the host knows them.
    std::span<const BodyPair> on_host() const { return on_host_; }
    /// Rows of two words, body a and body b, a < b.
    const GrowableBuffer& rows() const { return rows_; }

private:
    void upload(std::span<const BodyPair> pairs);
    bool has(BodyPair pair) const;
    void upload_given(std::span<const BodyPair> given);
    void make_stage();

    const Hierarchy& hierarchy_;
    LaunchShape shape_;
    const Bodies& bodies_;
    std::uint64_t first_capacity_; ///< of pairs that the device finds
    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    Status::Writes writes_;
    std::optional<BroadSweep> broad_;   ///< the host's search; none where setting broad says device
    std::unique_ptr<BroadStage> stage_; ///< the device's, once it has to find any
    bool searches_ = false;             ///< the device searches in this frame
    bool sorted_ = false;               ///< bodies stand in the order of some frame
    std::vector<Role> roles_;           ///< by body, in a share; none without one
    std::vector<BodyPair> found_;       ///< by the host
    std::span<const BodyPair> on_host_; ///< of this launch, where the host knows them
    GrowableBuffer rows_;
};

} // namespace tandem
