// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"

#include <span>

namespace tandem {

/// Order-free digest of pairs, by the definition that pairs.clh implements on devices.
Digest digest_of(std::span<const Pair> pairs);
Digest digest_of(const Pair& pair);

} // namespace tandem
