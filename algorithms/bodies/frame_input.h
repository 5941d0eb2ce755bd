// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/device_frame.h"
#include "base/error.h"
#include "scenes/scene.h"

#include <string>

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
