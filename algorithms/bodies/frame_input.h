// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/device_frame.h"
#include "base/error.h"
#include "scenes/scene.h"

#include <string>
#include <variant>

namespace tandem {

/// A frame, and its successor if the session has motion=linear. Both must outlive the object.
struct FrameInput {
    FrameInput(const Frame& first) : frame(first) {} // implicit: a frame alone is an input
    FrameInput(const Frame& first, const Frame* second) : frame(first), next(second) {}

    const Frame& frame;
    const Frame* next = nullptr; ///< null: the session has motion=none
};

/// The same in the memory of a device.
struct DeviceFrameInput {
    DeviceFrameInput(const DeviceFrame& first) : frame(first) {}
    DeviceFrameInput(const DeviceFrame& first, const DeviceFrame* second) : frame(first), next(second) {}

    const DeviceFrame& frame;
    const DeviceFrame* next = nullptr;
};

/// What a session runs: a frame in the memory of the host, or of the session's only device, and its successor
/// if the session has motion=linear. The frames must outlive the object.
class FrameView {
public:
    FrameView(const Frame& frame) : input_(FrameInput(frame)) {} // implicit: a frame alone is a view
    FrameView(const Frame& frame, const Frame& next) : input_(FrameInput(frame, &next)) {}
    FrameView(const FrameInput& input) : input_(input) {}
    FrameView(const DeviceFrame& frame) : input_(DeviceFrameInput(frame)) {}
    FrameView(const DeviceFrame& frame, const DeviceFrame& next) : input_(DeviceFrameInput(frame, &next)) {}
    FrameView(const DeviceFrameInput& input) : input_(input) {}

    /// The same frames, which the caller has checked by check_frame (bodies/check_input.h), as the body
    /// pairs.
    FrameView checked() const {
        auto view = *this;
        view.is_checked_ = true;
        return view;
    }
    bool is_checked() const { return is_checked_; }

    /// The frames in the host's memory; null if they are in the device's.
    const FrameInput* on_host() const { return std::get_if<FrameInput>(&input_); }
    /// The frames in the device's memory; null if they are in the host's.
    const DeviceFrameInput* on_device() const { return std::get_if<DeviceFrameInput>(&input_); }
    bool has_next() const { return on_host() ? on_host()->next != nullptr : on_device()->next != nullptr; }

private:
    std::variant<FrameInput, DeviceFrameInput> input_;
    bool is_checked_ = false;
};

/// The result of `work` on a frame's successor. Its InputError names the successor, because the frame itself
/// has the same errors.
template<class Work>
decltype(auto) of_successor(const Work& work) {
    try {
        return work();
    } catch (const InputError& error) {
        throw InputError(std::string("successor: ") + error.what());
    }
}

/// Throws InputError if `next` lacks bodies or vertices of `frame`.
void check_successor(const Frame& frame, const Frame& next);

/// The tetrahedra that one of two frames skips: they are in no bound of motion=linear. Lists as
/// Frame::skipped.
std::vector<std::vector<std::uint32_t>>
skipped_in_either(const std::vector<std::vector<std::uint32_t>>& frame,
                  const std::vector<std::vector<std::uint32_t>>& next);

} // namespace tandem
