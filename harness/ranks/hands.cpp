// SPDX-License-Identifier: MIT
#include "harness/ranks/hands.h"

#include <algorithm>
#include <array>
#include <map>

namespace tandem {

namespace {

/// What decides whether times of cells of a scene are compared (harness/table/table.h: comparable()).
std::vector<std::string> bounds_of(const Cell& cell) {
    const auto texts = cell.settings.texts();
    std::vector<std::string> bounds;
    for (const auto* name : {"k", "axes", "precision", "rounding", "placement", "origin", "output"}) {
        const auto found = texts.find(name);
        bounds.push_back(found == texts.end() ? "" : found->second);
    }
    return bounds;
}

} // namespace

std::vector<Hand> hands_of(std::size_t group, std::span<const Cell> cells, bool each_by_itself) {
    std::vector<Hand> hands;
    std::map<std::pair<Models, std::vector<std::string>>, std::size_t> known;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto models = models_of(cells[i].devices);
        const auto [found, is_new] = known.try_emplace({models, bounds_of(cells[i])}, hands.size());
        if (is_new || each_by_itself) {
            found->second = hands.size();
            hands.push_back({group, {}, models});
        }
        hands[found->second].cells.push_back(i);
    }
    return hands;
}

bool Dealer::fits(const Hand& hand, int rank) const {
    return !left_out_.contains(rank) && !hand.refused_by.contains(rank)
           && !roster_.devices_of(rank, hand.models).empty();
}

std::optional<Hand> Dealer::next(int rank) {
    const auto found = std::ranges::find_if(waiting_, [&](const Hand& hand) { return fits(hand, rank); });
    if (found == waiting_.end()) return std::nullopt;
    auto hand = std::move(*found);
    waiting_.erase(found);
    return hand;
}

std::vector<Hand> Dealer::take_undealable() {
    const auto is_dealable = [&](const Hand& hand) {
        for (int rank = 0; rank < static_cast<int>(roster_.members().size()); ++rank)
            if (fits(hand, rank)) return true;
        return false;
    };
    const auto rest = std::stable_partition(waiting_.begin(), waiting_.end(), is_dealable);
    std::vector<Hand> undealable(std::make_move_iterator(rest), std::make_move_iterator(waiting_.end()));
    waiting_.erase(rest, waiting_.end());
    return undealable;
}

} // namespace tandem
