// SPDX-License-Identifier: MIT
#pragma once

#include "harness/compare/cells.h"

namespace tandem::compare {

/// Why two files without a cell in common have none, and what to do: one line.
std::string why_nothing_common(const RecordedCells& before, const RecordedCells& after);

} // namespace tandem::compare
