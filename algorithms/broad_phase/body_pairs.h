// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/growable_buffer.h"
#include "algorithms/answer/status.h"
#include "algorithms/bodies/build_context.h"
#include "algorithms/broad_phase/broad.h"
#include "algorithms/broad_phase/broad_stage.h"
#include "algorithms/hierarchy/hierarchy.h"

#include <memory>
#include <optional>

namespace tandem {

/// A frame's body pairs on a device. They are found by the device or the host, according to setting broad, or
/// are passed to run().
class BodyPairs {
public:
    /// `writes`: whether uploads of pairs wait. The arguments must outlive this.
    BodyPairs(const BuildContext& context, const Hierarchy& hierarchy, Status::Writes writes);

    /// Starts a frame: uploads `given` pairs, or those that the host finds. Throws InputError for more than
    /// 2^32 - 1 pairs.
    void begin(const FrameInput& input, std::optional<std::span<const BodyPair>> given);
    /// Starts a frame in the device's memory, after its refit. Without `given` the device finds the pairs,
    /// independent of setting broad. Throws InputError for broad=sphere_boxes, which finds other pairs.
    void begin_on_device(std::optional<std::span<const BodyPair>> given);
    /// Whether begin() has so much work on the host that the device should get earlier commands first.
    bool works_on_host(bool given) const { return !given && (broad_ || !sorted_); }
    /// Whether the host waits in begin_on_device() for the positions of bodies.
    bool sorts_on_device(bool given) const { return !given && !sorted_; }
    /// Starts a batch: uploads a part of the frame's pairs.
    void begin_part(std::span<const BodyPair> part);
    /// Enqueues the search of the device, if the device finds the pairs.
    void launch(const Status& status);
    /// After a launch, grows the buffer to the number of pairs found. Returns true if the search must run
    /// again. Throws OutOfMemory.
    bool grow(const Status& status);
    /// The frame's pairs in ascending order, after a launch. Pairs of the device are downloaded. If its
    /// buffer is too small for them, the host finds them; for a frame in the device's memory (`input` = null)
    /// that is impossible and throws OutOfMemory.
    std::vector<BodyPair> list(const FrameInput* input, const Status& status) const;
    /// From the next frame on, finds the pairs of this subdomain. `given` pairs are not filtered.
    void set_subdomain(const Subdomain& subdomain);

    /// Whether the pairs are all whose volumes overlap: found, and not given or a part of the frame's.
    bool complete() const { return complete_; }
    /// Whether the device finds the current pairs.
    bool searched() const { return searches_; }
    /// The current pairs; empty if the device finds them.
    std::span<const BodyPair> on_host() const { return on_host_; }
    /// Rows of two words, body a and body b, a <= b.
    const GrowableBuffer& rows() const { return rows_; }

private:
    void upload(std::span<const BodyPair> pairs);
    void keep_part();
    bool contains(BodyPair pair) const;
    void upload_given(std::span<const BodyPair> given);
    void make_stage();

    const Hierarchy& hierarchy_;
    LaunchShape shape_;
    const Bodies& bodies_;
    SelfPairs self_;
    Broad method_;
    std::size_t first_ = 0, most_ = 0; ///< settings first_body_pair, most_body_pairs
    std::uint64_t first_capacity_;     ///< initial capacity for pairs that the device finds
    Device& device_;
    const Scene& scene_;
    Geometry geometry_;
    Status::Writes writes_;
    std::optional<BroadSweep> broad_;   ///< search of the host; none with broad=device
    std::unique_ptr<BroadStage> stage_; ///< search of the device; created at its first use
    bool searches_ = false;             ///< the device searches in this frame
    bool complete_ = false;             ///< the current pairs are complete()
    bool sorted_ = false;               ///< bodies are sorted by an earlier frame or by subdomain
    std::vector<Role> roles_;           ///< by body; empty without a subdomain
    std::vector<BodyPair> found_;       ///< by the host
    std::span<const BodyPair> on_host_; ///< current pairs, if not found by the device
    GrowableBuffer rows_;
};

} // namespace tandem
