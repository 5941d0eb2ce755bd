// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tandem {

/// A column of a table: its head and one text a row. Tables omit a column whose texts are all empty.
struct Column {
    std::string head;
    std::vector<std::string> texts;
};

/// Formats a table in lines of at most 100 characters: the labels, then as many right-aligned columns as fit.
/// Further blocks repeat the labels for the remaining columns. A label of more than 44 characters has a line
/// of its own.
std::string in_columns(const std::vector<std::string>& labels, const std::string& head,
                       const std::vector<Column>& columns);

/// Milliseconds with three decimals below 100, and with one from 100 on.
std::string milliseconds(double ms);

/// "1.23 M" or "1.23 G" from 10^5 on, all digits below.
std::string short_count(std::uint64_t count);

} // namespace tandem
