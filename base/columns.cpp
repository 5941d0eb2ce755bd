// SPDX-License-Identifier: MIT
#include "base/columns.h"

#include "base/standard_streams.h"
#include "base/text_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <span>

namespace tandem {

namespace {

constexpr std::size_t gap = 2;

/// Labels up to this width stand beside their row.
std::size_t longest_label() { return std::max<std::size_t>(44, output_columns() * 2 / 5); }

bool is_empty(const TableColumn& column) {
    return std::ranges::all_of(column.texts, [](const auto& text) { return text.empty(); });
}

std::string right(const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, width_of(text)), ' ') + text;
}

std::size_t width_of_column(const TableColumn& column) {
    std::size_t width = width_of(column.head);
    for (const auto& text : column.texts) width = std::max(width, width_of(text));
    return width;
}

std::string block(const std::vector<std::string>& labels, const std::string& head, std::size_t label_width,
                  std::span<const TableColumn* const> columns) {
    std::string text = fmt::format("{:<{}}", head, label_width);
    for (const auto* column : columns)
        text += std::string(gap, ' ') + right(column->head, width_of_column(*column));
    text += '\n';
    for (std::size_t row = 0; row < labels.size(); ++row) {
        const bool own_line = labels[row].size() > label_width;
        text += own_line ? fmt::format("{}\n{:<{}}", fmt::join(wrap(labels[row], output_columns()), "\n"), "",
                                       label_width)
                         : fmt::format("{:<{}}", labels[row], label_width);
        for (const auto* column : columns)
            text += std::string(gap, ' ') + right(column->texts[row], width_of_column(*column));
        text += '\n';
    }
    return text;
}

/// A cell of a Markdown table, in which a bar would end it.
std::string markdown_cell(const std::string& text) {
    std::string cell = " ";
    for (const char byte : text) cell += byte == '|' ? "\\|" : std::string(1, byte);
    return cell + " |";
}

std::string markdown_table(const std::vector<std::string>& labels, const std::string& head,
                           const std::vector<TableColumn>& columns) {
    auto text = "|" + markdown_cell(head), rule = std::string("|---|");
    for (const auto& column : columns)
        if (!is_empty(column)) text += markdown_cell(column.head), rule += "---:|";
    text += "\n" + rule + "\n";
    for (std::size_t row = 0; row < labels.size(); ++row) {
        text += "|" + markdown_cell(labels[row]);
        for (const auto& column : columns)
            if (!is_empty(column)) text += markdown_cell(column.texts[row]);
        text += "\n";
    }
    return text;
}

/// The least and the largest amount but zeros; 0, 0 without any.
std::pair<double, double> range_of(const std::vector<std::optional<double>>& amounts) {
    double least = 0, most = 0;
    for (const auto& amount : amounts)
        if (amount && *amount > 0) {
            least = least > 0 ? std::min(least, *amount) : *amount;
            most = std::max(most, *amount);
        }
    return {least, most};
}

struct Unit {
    const char* name;
    double scale;
};

Unit unit_for(double least, double most) {
    constexpr std::array units{Unit{"G ", 1e9}, Unit{"M ", 1e6}, Unit{"k ", 1e3}};
    if (most >= 1e5)
        for (const auto& unit : units)
            if (least >= 0.1 * unit.scale) return unit;
    return {"", 1};
}

} // namespace

std::string in_columns(const std::vector<std::string>& labels, const std::string& head,
                       const std::vector<TableColumn>& columns, TableFormat format) {
    if (format == TableFormat::markdown) return markdown_table(labels, head, columns);
    const auto line_columns = output_columns(), longest = longest_label();
    std::size_t label_width = head.size();
    for (const auto& label : labels)
        if (label.size() <= longest) label_width = std::max(label_width, label.size());
    std::string text;
    std::vector<const TableColumn*> pending;
    std::size_t width = label_width;
    for (const auto& column : columns) {
        if (is_empty(column)) continue;
        const auto own = gap + width_of_column(column);
        if (!pending.empty() && width + own > line_columns) {
            text += block(labels, head, label_width, pending) + "\n";
            pending.clear();
            width = label_width;
        }
        pending.push_back(&column);
        width += own;
    }
    return pending.empty() ? text : text + block(labels, head, label_width, pending);
}

std::vector<std::string> millisecond_texts(const std::vector<double>& ms) {
    const auto [least, most] = range_of({ms.begin(), ms.end()});
    int decimals = 3;
    if (least >= 100) decimals = 1;
    if (most > 0 && most < 0.1) decimals = 5;
    std::vector<std::string> texts;
    for (const double value : ms) texts.push_back(fmt::format("{:.{}f}", value, decimals));
    return texts;
}

std::string milliseconds(double ms) { return millisecond_texts({ms}).front(); }

/// The least amount has four digits where its unit allows, so that all others have at least as many.
TableColumn amounts_column(const std::string& head, const std::vector<std::optional<double>>& amounts) {
    const auto [least, most] = range_of(amounts);
    const auto unit = unit_for(least, most);
    const bool is_whole = unit.scale == 1 && std::ranges::all_of(amounts, [](const auto& amount) {
                              return !amount || *amount == std::floor(*amount);
                          });
    const int digits_before =
        least > 0 ? static_cast<int>(std::floor(std::log10(least / unit.scale))) + 1 : 1;
    const int decimals = is_whole ? 0 : std::clamp(4 - digits_before, 0, 4);
    TableColumn column{unit.name + head, {}};
    for (const auto& amount : amounts)
        column.texts.push_back(!amount     ? "-"
                               : most == 0 ? ""
                                           : fmt::format("{:.{}f}", *amount / unit.scale, decimals));
    return column;
}

} // namespace tandem
