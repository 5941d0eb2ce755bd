// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/answer.h"

namespace tandem::python {

/// A frame that was enqueued: its answer is complete once the device has come to it. Calls but collect() read
/// what does not change.
class Queued {
public:
    Queued(std::shared_ptr<Collider> collider, QueuedFrame frame, std::uint64_t number)
        : collider_(std::move(collider)), frame_(std::move(frame)), number_(number) {}
    Queued(const Queued&) = delete;
    Queued& operator=(const Queued&) = delete;
    ~Queued();

    const QueuedFrame& frame() const { return frame_; }
    const std::shared_ptr<Collider>& collider() const { return collider_; }
    /// Session::collect(). Throws InputError unless this is the collider's last frame.
    std::unique_ptr<Answer> collect() const;

private:
    std::shared_ptr<Collider> collider_;
    QueuedFrame frame_;
    std::uint64_t number_; ///< CollideRun::number
};

/// Adds Queued.
void bind_queued(nanobind::module_& module);

} // namespace tandem::python
