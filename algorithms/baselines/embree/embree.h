// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// Intel's Embree, rtcCollide over one tree per body: the usual choice on a processor. A baseline for one
/// precision and one k, on device host.
const Traversal& embree();

} // namespace tandem
