// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/pipeline.h"

namespace tandem {

/// A session on one device whose data stay there: a frame is a fixed sequence of commands and one wait. Past
/// capacity counters count on, buffers grow and the walk runs again; a frame that does not fit into memory
/// runs in batches.
std::unique_ptr<Session> resident_session(const Traversal& traversal, Device& device, const Scene& scene,
                                          Settings fitted);

} // namespace tandem
