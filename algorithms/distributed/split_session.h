// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// A session on several devices, which share a frame's body pairs: each owns some of the bodies and has the
/// pairs that shares/share.h says, all at the same time. It moves and bounds only the bodies that it needs.
/// With broad=device each finds its own pairs; otherwise, and where run() is given some, the host deals them
/// out by the same rule. `fitted`: of each device.
std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, const std::vector<Settings>& fitted);

} // namespace tandem
