// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"

#include <span>

namespace tandem {

/// Order-free digest of pairs on the host, with the definition of pairs.clh.
Digest digest_of(std::span<const Pair> pairs);
Digest digest_of(const Pair& pair);

} // namespace tandem
