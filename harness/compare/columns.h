// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <vector>

namespace tandem::compare {

constexpr std::size_t table_columns = 7;
using TableRow = std::array<std::string, table_columns>;

/// Rows in columns, two spaces between, in a line's columns. The first and the last but one are aligned to
/// the left, the others to the right. What is too long for the first stands in a line above.
std::string table(const std::vector<TableRow>& rows);

} // namespace tandem::compare
