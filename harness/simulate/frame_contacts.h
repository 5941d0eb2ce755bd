// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/inputs.h"

#include <memory>
#include <string>
#include <vector>

namespace tandem {

/// Finds the contacts of one frame after the other, on one device, by the first algorithm as it comes.
class FrameContacts {
public:
    /// The scene must outlive it. Throws InputError.
    FrameContacts(const std::string& device, const Scene& scene);

    /// Coordinates are checked frame by frame: who exports opens them one at a time, however many there are.
    std::vector<ContactPoint> of(const Frame& frame);

private:
    const Scene& scene_;
    std::vector<BackendReport> backends_;
    Cell cell_;
    std::unique_ptr<Session> session_;
};

} // namespace tandem
