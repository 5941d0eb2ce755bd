// SPDX-License-Identifier: MIT
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>
#include <utility>
#include <vector>

namespace tandem {

namespace {

/// More edits than these make another word, not a mistyped one.
constexpr std::size_t most_edits = 2;

/// Levenshtein distance, one row at a time.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        auto diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const auto changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = row[j];
            row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
        }
    }
    return row.back();
}

} // namespace

std::string nearest(std::string_view name, std::span<const std::string> candidates) {
    const std::string* best = nullptr;
    auto least = most_edits + 1;
    for (const auto& candidate : candidates) {
        if (name.size() >= candidate.size() + least || candidate.size() >= name.size() + least)
            continue; // saves the distance to very long words
        const auto edits = distance(name, candidate);
        if (edits >= least) continue;
        best = &candidate;
        least = edits;
    }
    return best == nullptr ? std::string() : *best;
}

std::string unknown(std::string_view what, std::string_view name, std::span<const std::string> candidates) {
    if (candidates.empty()) return fmt::format("unknown {} '{}'; there is none", what, name);
    const auto near = nearest(name, candidates);
    const auto hint = near.empty() ? std::string() : fmt::format("; the nearest is '{}'", near);
    return fmt::format("unknown {} '{}'{} (there are: {})", what, name, hint, fmt::join(candidates, ", "));
}

} // namespace tandem
