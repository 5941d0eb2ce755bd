// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// Intel's Embree, rtcCollide over a tree a body: what a user of a processor would otherwise take. A peer:
/// one precision, one k, device host.
const Traversal& embree();

} // namespace tandem
