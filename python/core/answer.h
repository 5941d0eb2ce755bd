// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/collider.h"

namespace tandem::python {

/// What a frame's run found. Downloads and sums wait for the collider's other users, without the
/// interpreter's lock.
class Answer {
public:
    Answer(std::shared_ptr<Collider> collider, FrameResult result, double seconds)
        : collider_(std::move(collider)), result_(std::move(result)), seconds_(seconds) {}
    Answer(const Answer&) = delete;
    Answer& operator=(const Answer&) = delete;
    ~Answer();

    const FrameResult& result() const { return result_; }
    double seconds() const { return seconds_; }
    Digest digest() const;
    Digest contact_digest() const;
    /// Sorted. Throw InputError where the settings keep none.
    std::vector<Pair> pairs() const;
    std::vector<ContactPoint> contacts() const;

    /// Pairs as rows of four words in memory of the device they were found on.
    struct OnDevice {
        Buffer rows;
        int type = 0;   ///< as DLPack numbers kinds of devices
        int number = 0; ///< of those of its kind
    };
    /// Written there at the first call, in no order, and known to be once it returns. Throws InputError where
    /// DLPack cannot name the memory, DeviceError where pairs are not all on one device.
    const OnDevice& on_device() const;

private:
    /// Throws InputError where the settings keep no pairs. With the collider's lock.
    void check_kept() const;

    std::shared_ptr<Collider> collider_;
    FrameResult result_;
    double seconds_;
    mutable std::optional<OnDevice> on_device_;
};

/// Adds Answer.
void bind_answer(nanobind::module_& module);

} // namespace tandem::python
