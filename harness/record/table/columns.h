// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

/// A column of a table: its head and one text a row. What is empty everywhere is left out.
struct Column {
    std::string head;
    std::vector<std::string> texts;
};

/// Lines of at most 100 columns: the labels, then as many columns as fit, aligned to the right; the rest in
/// further blocks with the labels again. A label that is longer than a line's half stands in a line of its
/// own.
std::string in_columns(const std::vector<std::string>& labels, const std::string& head,
                       const std::vector<Column>& columns);

/// Milliseconds as a table has them: three digits behind the point below 100, one above.
std::string milliseconds(double ms);

/// "1.23 M" from 10^5 on, the number itself below.
std::string short_count(std::uint64_t count);

} // namespace tandem
