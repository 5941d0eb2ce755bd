// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

namespace tandem {

/// Tiles of 32 boxes against 32: the paper's chunks without inner trees.
const Traversal& tiled();

} // namespace tandem
