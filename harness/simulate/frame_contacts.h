// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/inputs.h"
#include "scenes/export/surfaces.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tandem {

/// Finds the contacts of frames on one device, with the first algorithm and its default settings but the
/// contact rule.
class FrameContacts {
public:
    /// `devices`: one device, which must outlive this object, as must the scene. `rule`: as setting
    /// contact_rule; empty: the default. Throws InputError.
    FrameContacts(std::span<const DeviceGroup> devices, const Scene& scene, const std::string& rule = {});

    /// Checks the coordinates of this frame, because an export opens only one frame at a time. Throws
    /// InputError.
    std::vector<ContactPoint> find(const Frame& frame);

    /// Of rule pressure: the rows of a frame with the corners of their polygons.
    SurfaceFrames surfaces(std::size_t number, const Frame& frame);

private:
    FrameResult run(const Frame& frame);

    const Scene& scene_;
    Cell cell_;
    std::unique_ptr<Session> session_;
};

} // namespace tandem
