// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// A session on several devices, which share a frame's body pairs: the host finds them and deals them out
/// evenly, each device has all bodies and walks its own pairs, all at the same time. `fitted`: of each
/// device; with broad=device all settle for broad=tight, since nobody could deal out pairs that a device has
/// found.
std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, std::vector<Settings> fitted);

} // namespace tandem
