// SPDX-License-Identifier: MIT
#include "harness/record/table/columns.h"

#include "base/text_lines.h"

#include <algorithm>
#include <fmt/format.h>
#include <span>

namespace tandem {

namespace {

constexpr std::size_t longest_label = 44;
constexpr std::size_t gap = 2;

std::string right(const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, width_of(text)), ' ') + text;
}

std::size_t width_of_column(const Column& column) {
    std::size_t width = width_of(column.head);
    for (const auto& text : column.texts) width = std::max(width, width_of(text));
    return width;
}

std::string block(const std::vector<std::string>& labels, const std::string& head, std::size_t label_width,
                  std::span<const Column* const> columns) {
    std::string text = fmt::format("{:<{}}", head, label_width);
    for (const auto* column : columns)
        text += std::string(gap, ' ') + right(column->head, width_of_column(*column));
    text += '\n';
    for (std::size_t row = 0; row < labels.size(); ++row) {
        const bool own_line = labels[row].size() > label_width;
        text += own_line ? labels[row] + "\n" + std::string(label_width, ' ')
                         : fmt::format("{:<{}}", labels[row], label_width);
        for (const auto* column : columns)
            text += std::string(gap, ' ') + right(column->texts[row], width_of_column(*column));
        text += '\n';
    }
    return text;
}

} // namespace

std::string in_columns(const std::vector<std::string>& labels, const std::string& head,
                       const std::vector<Column>& columns) {
    std::size_t label_width = head.size();
    for (const auto& label : labels)
        if (label.size() <= longest_label) label_width = std::max(label_width, label.size());
    std::string text;
    std::vector<const Column*> pending;
    std::size_t width = label_width;
    for (const auto& column : columns) {
        if (std::ranges::all_of(column.texts, [](const auto& t) { return t.empty(); })) continue;
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

std::string milliseconds(double ms) {
    return ms < 100 ? fmt::format("{:.3f}", ms) : fmt::format("{:.1f}", ms);
}

std::string short_count(std::uint64_t count) {
    const auto value = static_cast<double>(count);
    if (count < 100'000) return fmt::format("{}", count);
    if (count < 100'000'000) return fmt::format("{:.4g} M", value * 1e-6);
    return fmt::format("{:.4g} G", value * 1e-9);
}

} // namespace tandem
