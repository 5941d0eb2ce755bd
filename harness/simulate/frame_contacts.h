// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/inputs.h"

#include <memory>
#include <string>
#include <vector>

namespace tandem {

/// Finds the contacts of frames on one device, with the first algorithm and its default settings.
class FrameContacts {
public:
    /// The scene must outlive this object. Throws InputError.
    FrameContacts(const std::string& device, const Scene& scene);

    /// Checks the coordinates of this frame, because an export opens only one frame at a time. Throws
    /// InputError.
    std::vector<ContactPoint> find(const Frame& frame);

private:
    const Scene& scene_;
    std::vector<BackendReport> backends_;
    Cell cell_;
    std::unique_ptr<Session> session_;
};

} // namespace tandem
