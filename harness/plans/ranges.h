// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// The values of a range. "A..B*F" is A, A F, A F F, ... up to B. "A..B:S" is A, A + S, ... up to B; "A..B"
/// has S = 1. Any other text is one value. A and B are numbers from 0, F is above 1, S is above 0. Whole
/// numbers stay whole. Throws InputError that quotes `whole` for an invalid or endless range, or more than
/// 10,000 values.
std::vector<std::string> expand_range(std::string_view text, const std::string& whole);

} // namespace tandem
