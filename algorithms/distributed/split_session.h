// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// A session on several devices of this process. The bodies are partitioned: each device owns a subdomain,
/// places and bounds only the bodies of it, and processes its pairs (subdomain.h) in parallel to the rest.
/// With broad=device each device finds its own pairs. Otherwise, and for pairs passed to run(), the host
/// distributes the pairs by the same rule. `fitted`: Traversal::fitted for each device.
std::unique_ptr<Session> split_session(const Traversal& traversal, std::span<Device* const> devices,
                                       const Scene& scene, const std::vector<Settings>& fitted);

} // namespace tandem
