// SPDX-License-Identifier: MIT
#pragma once

#include "harness/ranks/swept_groups.h"

#include <span>
#include <string>

namespace tandem {

/// How many times as long as the first comparable cell each takes, a column for each model of device, as the
/// paper's Table 4 has one for each GPU; a table a scene. Empty where only one model was measured.
std::string model_tables(std::span<const SweptGroup> groups);

} // namespace tandem
