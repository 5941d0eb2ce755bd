// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/choices.h"
#include "scenes/scene.h"

#include <string>

namespace tandem {

/// Why no frame of the scene can have a pair, and what to do, for messages: no two bodies may meet, and
/// setting self pairs no body with itself. Empty if something may meet.
std::string why_nothing_meets(const Scene& scene, SelfPairs self);

} // namespace tandem
