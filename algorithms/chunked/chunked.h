// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// The chunked static scheduler of the paper.
const Traversal& chunked();

} // namespace tandem
