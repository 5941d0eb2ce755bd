// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// A session with the paper's data path: every frame converts, uploads and reads back everything, with
/// contacts after every part of a walk.
std::unique_ptr<Session> published_session(const Traversal& traversal, Device& device, const Scene& scene,
                                           Settings fitted);

} // namespace tandem
