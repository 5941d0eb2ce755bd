// SPDX-License-Identifier: MIT
#pragma once

#include "harness/verify/contact_surfaces.h"
#include "python/core/collider.h"

namespace tandem::python {

/// Result of one frame. Downloads and digests take the collider's lock; callers first release the
/// interpreter's lock.
class Answer {
public:
    /// `queued`: of a frame of enqueue(), whose memory the next such frame overwrites.
    Answer(std::shared_ptr<Collider> collider, CollideRun run, bool queued = false)
        : collider_(std::move(collider)),
          result_(std::move(run.result)),
          seconds_(run.seconds),
          frame_(std::move(run.frame)),
          number_(run.number),
          is_queued_(queued) {}
    Answer(const Answer&) = delete;
    Answer& operator=(const Answer&) = delete;
    ~Answer();

    const FrameResult& result() const { return result_; }
    double seconds() const { return seconds_; }
    Digest digest() const;
    Digest contact_digest() const;
    /// Sorted. Throw InputError if the settings keep no pairs or make no contacts.
    std::vector<Pair> pairs() const;
    std::vector<ContactPoint> contacts() const;
    /// Contacts of a rule that measures distances. Throws InputError also for other rules; contacts() for
    /// this.
    std::vector<ContactPoint> distances() const;
    /// Polygons of equal pressure; throws InputError also for other rules and with output=wrenches.
    std::vector<ContactPoint> polygons() const;
    /// Their corners. Needs the frame as meeting().
    ContactSurfaces surfaces() const;
    /// The rows of output=wrenches. Throws InputError with other outputs.
    std::vector<ContactPoint> wrenches() const;
    /// Those of pairs() whose tetrahedra meet in the frame (meeting_of). A frame in memory of a device is
    /// read back from what the last run left there. Throws InputError also if another run has followed that
    /// one, and with placement=exact, whose vertices have no such numbers.
    std::vector<Pair> meeting() const;

    /// Pairs as rows of four words in memory of the device that found them.
    struct OnDevice {
        Buffer rows;
        int type = 0;   ///< DLPack's number of the device type
        int number = 0; ///< number of the device among those of its type
    };
    /// The first call writes the rows, in canonical order, and waits until they are complete. Throws
    /// InputError if DLPack has no name for the memory, DeviceError if the pairs are not all on one device.
    const OnDevice& on_device() const;

private:
    /// Throws InputError if a later frame has overwritten the answer. Needs the collider's lock.
    void check_current() const;
    /// The same, and if the settings keep no pairs.
    void check_pairs_kept() const;
    /// The tetrahedra that the kernels had, relative to the answer's origin. `asks`: the function that needs
    /// them. Throws InputError if the frame is overwritten, and with placement=exact. Needs the lock.
    oracle::World world(const char* asks) const;

    std::shared_ptr<Collider> collider_;
    FrameResult result_;
    double seconds_;
    std::shared_ptr<const Frame> frame_; ///< null if it was in memory of the device
    std::uint64_t number_;               ///< CollideRun::number
    bool is_queued_;
    mutable std::optional<OnDevice> on_device_;
};

/// Adds Answer.
void bind_answer(nanobind::module_& module);

} // namespace tandem::python
