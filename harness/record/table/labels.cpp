// SPDX-License-Identifier: MIT
#include "harness/record/table/labels.h"

#include "base/text_lines.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <set>

namespace tandem {

namespace {

/// A property that can distinguish rows, in the order of a label.
struct LabelPart {
    std::string name, text;
    bool is_setting = false;
    bool is_explicit = true; ///< no preset implies it, so that the common text lists it
};
using Parts = std::vector<LabelPart>;

Parts parts_of(const Row& row) {
    const auto& cell = *row.cell;
    Parts parts{{"algorithm", std::string(cell.algorithm->name())}, {"preset", cell.preset}};
    const auto changed = changes(cell);
    for (const auto& [name, value] : cell.settings.texts())
        parts.push_back({name, fmt::format("{}={}", name, value), true, changed.contains(name)});
    parts.push_back({"device", "on " + name_of(cell.devices)});
    return parts;
}

std::string text_of(const Parts& parts, const std::string& name) {
    const auto found = std::ranges::find_if(parts, [&](const LabelPart& part) { return part.name == name; });
    return found == parts.end() ? std::string() : found->text;
}

/// Settings that determine the candidate pairs for every algorithm; cells that differ in them are not
/// compared.
constexpr std::array geometry_names{"k", "axes", "precision", "rounding", "placement", "origin"};

bool is_geometry(const LabelPart& part) {
    return std::ranges::find(geometry_names, part.name) != geometry_names.end();
}

/// The group of rows within which a part is compared. A setting is compared within one algorithm and preset,
/// because the preset implies its value.
std::string scope_of(const LabelPart& part, const Parts& parts) {
    return part.is_setting && !is_geometry(part) ? parts[0].text + " " + parts[1].text : "";
}

/// The texts of all rows for each scope and name of a part; empty for a row without the part.
class Texts {
public:
    explicit Texts(const std::vector<Parts>& rows) {
        for (const auto& parts : rows) {
            for (const auto& part : parts) texts_[{scope_of(part, parts), part.name}].insert(part.text);
            for (const auto* name : geometry_names) texts_[{"", name}].insert(text_of(parts, name));
        }
    }
    bool vary(const LabelPart& part, const Parts& parts) const {
        return texts_.at({scope_of(part, parts), part.name}).size() > 1;
    }

private:
    std::map<std::pair<std::string, std::string>, std::set<std::string>> texts_;
};

std::set<std::string> varying_names(const Parts& parts, const Texts& texts) {
    std::set<std::string> varying;
    for (const auto& part : parts)
        if (texts.vary(part, parts)) varying.insert(part.name);
    return varying;
}

/// A single swept setting is in every label. With several, a label has only the values that its preset does
/// not imply, because labels would otherwise be longer than lines.
bool is_in_label(const LabelPart& part, const Parts& parts, const std::set<std::string>& varying) {
    if (part.name == "algorithm") return true;
    if (!varying.contains(part.name)) return false;
    if (!part.is_setting || is_geometry(part) || part.is_explicit) return true;
    return std::ranges::count_if(parts,
                                 [&](const LabelPart& other) {
                                     return other.is_setting && !is_geometry(other)
                                            && varying.contains(other.name);
                                 })
           == 1;
}

void append_word(std::string& text, const std::string& word) {
    if (!word.empty()) text += (text.empty() ? "" : " ") + word;
}

} // namespace

RowLabels row_labels(std::span<const Row> rows) {
    std::vector<Parts> all;
    for (const auto& row : rows) all.push_back(parts_of(row));
    std::set<std::string> listed{"algorithm"}, varying_anywhere;
    std::vector<std::set<std::string>> varying;
    const Texts texts(all);
    for (const auto& parts : all) {
        varying.push_back(varying_names(parts, texts));
        varying_anywhere.insert(varying.back().begin(), varying.back().end());
    }
    RowLabels labels;
    for (std::size_t i = 0; i < all.size(); ++i) {
        auto& label = labels.by_row.emplace_back();
        for (const auto& part : all[i]) {
            if (is_in_label(part, all[i], varying[i]))
                append_word(label, part.text);
            else if (!varying_anywhere.contains(part.name) && part.is_explicit
                     && listed.insert(part.name).second)
                labels.common += (labels.common.empty() ? "" : ", ")
                                 + (part.name == "preset" ? "preset " + part.text : part.text);
        }
    }
    for (auto& label : labels.by_row) label = visible(label);
    labels.common = visible(labels.common);
    return labels;
}

} // namespace tandem
