// SPDX-License-Identifier: MIT
#include "harness/compare/labels.h"

#include <fmt/format.h>
#include <set>

namespace tandem::compare {

namespace {

/// Numbers of groups, one a cell: cells of one group are not told apart yet.
using Groups = std::vector<std::size_t>;

/// Whether cells of one group have several values.
bool tells_apart(const Groups& groups, const std::vector<std::string>& values) {
    std::map<std::size_t, std::string> first;
    for (std::size_t i = 0; i < groups.size(); ++i)
        if (first.try_emplace(groups[i], values[i]).first->second != values[i]) return true;
    return false;
}

Groups split(const Groups& groups, const std::vector<std::string>& values) {
    std::map<std::pair<std::size_t, std::string>, std::size_t> numbers;
    Groups finer;
    for (std::size_t i = 0; i < groups.size(); ++i)
        finer.push_back(numbers.try_emplace({groups[i], values[i]}, numbers.size()).first->second);
    return finer;
}

void append(std::string& text, const char* between, const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : between) + more;
}

/// Labels that grow, and what they do not tell apart yet.
struct Growing {
    std::span<const RecordedCell* const> cells;
    std::vector<std::string> labels;
    Groups groups;

    /// Appends a text for each cell where that tells cells apart.
    bool add(const std::vector<std::string>& texts) {
        if (!tells_apart(groups, texts)) return false;
        for (std::size_t i = 0; i < texts.size(); ++i) append(labels[i], " ", texts[i]);
        groups = split(groups, texts);
        return true;
    }
};

/// A digest says least, so it comes after the settings.
constexpr std::string_view last_name = "digest";

std::vector<std::string> names_of(std::span<const RecordedCell* const> cells, std::size_t name) {
    std::vector<std::string> texts;
    for (const auto* cell : cells) texts.push_back(cell->names[name].second);
    return texts;
}

/// "name=value" of a setting, one a cell; empty where the cell has no such setting.
std::vector<std::string> texts_of(const std::string& setting, std::span<const RecordedCell* const> cells) {
    std::vector<std::string> texts;
    for (const auto* cell : cells) {
        const auto found = cell->settings.find(setting);
        texts.push_back(found == cell->settings.end() ? "" : fmt::format("{}={}", setting, found->second));
    }
    return texts;
}

void add_settings(Growing& growing) {
    std::set<std::string> settings;
    for (const auto* cell : growing.cells)
        for (const auto& [name, value] : cell->settings) settings.insert(name);
    for (const auto& setting : settings) growing.add(texts_of(setting, growing.cells));
}

/// Cells whose keys differ in what no record names get numbers.
void number_equal(std::span<const RecordedCell* const> cells, std::vector<std::string>& labels) {
    std::map<std::string, std::map<std::string_view, std::size_t>> keys;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        auto& numbers = keys[labels[i]];
        const auto number = numbers.try_emplace(cells[i]->key, numbers.size() + 1).first->second;
        if (number > 1) labels[i] += fmt::format(" #{}", number);
    }
}

} // namespace

Labels label(std::span<const RecordedCell* const> cells) {
    if (cells.empty()) return {};
    const auto& names = cells.front()->names;
    const Groups one_group(cells.size(), 0);
    Growing growing{cells, std::vector<std::string>(cells.size()), one_group};
    std::string common;
    for (std::size_t name = 0; name < names.size(); ++name) {
        if (names[name].first == last_name) continue;
        const auto texts = names_of(cells, name);
        if (!growing.add(texts) && !tells_apart(one_group, texts)) append(common, ", ", texts.front());
    }
    add_settings(growing);
    for (std::size_t name = 0; name < names.size(); ++name)
        if (names[name].first == last_name) growing.add(names_of(cells, name));
    for (auto& text : growing.labels)
        if (text.empty()) text = names.front().second;
    number_equal(cells, growing.labels);
    return {std::move(growing.labels), std::move(common)};
}

} // namespace tandem::compare
