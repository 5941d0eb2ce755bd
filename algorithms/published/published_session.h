// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// A session with the paper's data path: everything is converted, uploaded and read back in every frame,
/// contacts after every part of a walk.
std::unique_ptr<Session> published_session(const Traversal& traversal, Device& device, const Scene& scene,
                                           Settings fitted);

} // namespace tandem
