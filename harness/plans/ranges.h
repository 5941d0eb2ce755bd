// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// The values that a text of a setting stands for: "A..B*F" A, A F, A F F, ... up to B; "A..B:S" A, A + S,
/// ... up to B; "A..B" with S = 1; anything else is one value. A and B are numbers from 0, F above 1, S above
/// 0; whole numbers stay whole. Throws InputError that names `whole` where there is no end, no value, or more
/// than 10,000.
std::vector<std::string> expand_range(std::string_view text, const std::string& whole);

} // namespace tandem
