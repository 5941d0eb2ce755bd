// SPDX-License-Identifier: MIT
#include "harness/table/labels.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <set>

namespace tandem {

namespace {

/// What a row may be told apart by, in the order of a label.
struct Part {
    std::string name, text;
    bool is_setting = false;
    bool is_said = true; ///< what all share is said of this one: no preset says it
};
using Parts = std::vector<Part>;

Parts parts_of(const Row& row) {
    const auto& cell = *row.cell;
    Parts parts{{"algorithm", std::string(cell.algorithm->name())}, {"preset", cell.preset}};
    const auto changed = changes(cell);
    for (const auto& [name, value] : cell.settings.texts())
        parts.push_back({name, name + "=" + value, true, changed.contains(name)});
    parts.push_back({"device", "on " + name_of(cell.devices)});
    if (!row.scene.empty()) parts.push_back({"scene", row.scene});
    return parts;
}

std::string text_of(const Parts& parts, const std::string& name) {
    const auto found = std::ranges::find_if(parts, [&](const Part& part) { return part.name == name; });
    return found == parts.end() ? std::string() : found->text;
}

/// What decides which pairs are candidates, whatever the algorithm: cells that differ in it are not compared.
constexpr std::array geometry_names{"k", "axes", "precision", "rounding", "placement"};

/// Other settings tell cells of one preset apart: it says what its own are.
bool counts_between(const Part& part, const Parts& a, const Parts& b) {
    return !part.is_setting || std::ranges::find(geometry_names, part.name) != geometry_names.end()
           || (a[0].text == b[0].text && a[1].text == b[1].text);
}

std::set<std::string> varying_names(const std::vector<Parts>& rows) {
    std::set<std::string> varying;
    for (const auto& a : rows)
        for (const auto& b : rows)
            for (const auto& part : a)
                if (counts_between(part, a, b) && text_of(b, part.name) != part.text)
                    varying.insert(part.name);
    return varying;
}

void append_word(std::string& text, const std::string& word) {
    if (!word.empty()) text += (text.empty() ? "" : " ") + word;
}

} // namespace

RowLabels row_labels(std::span<const Row> rows) {
    std::vector<Parts> all;
    for (const auto& row : rows) all.push_back(parts_of(row));
    const auto varying = varying_names(all);
    RowLabels labels;
    std::set<std::string> said{"algorithm"};
    for (const auto& parts : all) {
        auto& label = labels.of.emplace_back();
        for (const auto& part : parts) {
            if (part.name == "algorithm" || varying.contains(part.name))
                append_word(label, part.text);
            else if (part.is_said && said.insert(part.name).second)
                labels.common += (labels.common.empty() ? "" : ", ")
                                 + (part.name == "preset" ? "preset " + part.text : part.text);
        }
    }
    return labels;
}

} // namespace tandem
