// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tandem {

/// A column of a table: its head and one text a row. Tables omit a column whose texts are all empty.
struct TableColumn {
    std::string head;
    std::vector<std::string> texts;
};

enum class TableFormat { text, markdown };

/// Formats a table. As text, lines have at most output_columns() characters: the labels, then as many
/// right-aligned columns as fit. Further blocks repeat the labels for the remaining columns. A label of more
/// than 44 characters, or two fifths of a wider line, has a line of its own. As Markdown, each row is one
/// line, whatever its width.
std::string in_columns(const std::vector<std::string>& labels, const std::string& head,
                       const std::vector<TableColumn>& columns, TableFormat format = TableFormat::text);

/// Milliseconds with equally many decimals: three, one where all but zeros are at least 100, and five where
/// all are below 0.1.
std::vector<std::string> millisecond_texts(const std::vector<double>& ms);
/// One number as in a column of its own.
std::string milliseconds(double ms);

/// A column of amounts in one unit: the largest of k, M and G in which the least amount but zeros is at
/// least 0.1, and none where all amounts are below 10^5. The head begins with it: "M pairs". All texts are
/// empty where every amount is 0; an unknown amount is "-".
TableColumn amounts_column(const std::string& head, const std::vector<std::optional<double>>& amounts);

} // namespace tandem
