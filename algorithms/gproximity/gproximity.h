// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// gProximity's dynamic load balancing, implemented from scratch, with its published numbers as presets.
const Traversal& gproximity();

} // namespace tandem
