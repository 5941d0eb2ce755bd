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

/// "name=value" of a setting, one a cell; empty where the cell has no such setting.
std::vector<std::string> texts_of(const std::string& setting, std::span<const RecordedCell* const> cells) {
    std::vector<std::string> texts;
    for (const auto* cell : cells) {
        const auto found = cell->settings.find(setting);
        texts.push_back(found == cell->settings.end() ? "" : fmt::format("{}={}", setting, found->second));
    }
    return texts;
}

/// Adds what names tell apart, or all share, and returns what they leave together.
Groups label_by_names(std::span<const RecordedCell* const> cells, Labels& labels) {
    Groups groups(cells.size(), 0);
    for (std::size_t name = 0; name < cells.front()->names.size(); ++name) {
        std::vector<std::string> values;
        for (const auto* cell : cells) values.push_back(cell->names[name].second);
        if (tells_apart(groups, values)) {
            for (std::size_t i = 0; i < cells.size(); ++i) append(labels.of[i], " ", values[i]);
            groups = split(groups, values);
        } else if (!tells_apart(Groups(cells.size(), 0), values)
                   && cells.front()->names[name].first != "digest") {
            append(labels.common, ", ", values.front());
        }
    }
    return groups;
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
    Labels labels{std::vector<std::string>(cells.size()), {}};
    if (cells.empty()) return labels;
    auto groups = label_by_names(cells, labels);
    std::set<std::string> settings;
    for (const auto* cell : cells)
        for (const auto& [name, value] : cell->settings) settings.insert(name);
    for (const auto& setting : settings) {
        const auto texts = texts_of(setting, cells);
        if (!tells_apart(groups, texts)) continue;
        for (std::size_t i = 0; i < cells.size(); ++i) append(labels.of[i], " ", texts[i]);
        groups = split(groups, texts);
    }
    for (auto& text : labels.of)
        if (text.empty()) text = cells.front()->names.front().second;
    number_equal(cells, labels.of);
    return labels;
}

} // namespace tandem::compare
