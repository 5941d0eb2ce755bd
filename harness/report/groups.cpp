// SPDX-License-Identifier: MIT
#include "harness/report/groups.h"

#include "harness/compare/labels.h"
#include "harness/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>

namespace tandem::report {

namespace {

using compare::RecordedCell;

struct Bound {
    const char* name;
    const char* usual; ///< what goes without saying
};
/// Other bounds are other candidate pairs.
constexpr std::array bounds{Bound{"k", ""},
                            Bound{"axes", "standard"},
                            Bound{"precision", "float"},
                            Bound{"rounding", "safe"},
                            Bound{"placement", "rounded"},
                            Bound{"origin", "world"},
                            Bound{"output", "pairs"}};

/// As read_cell() puts them.
enum Name : std::size_t { devices = 2, model = 3, driver = 4, scene = 5, frames = 6, handling = 7 };

std::string name_of(const RecordedCell& cell, Name name) { return cell.names[name].second; }

std::string setting_of(const RecordedCell& cell, const Bound& bound) {
    const auto found = cell.settings.find(bound.name);
    return found == cell.settings.end() ? bound.usual : found->second;
}

std::string key_of(const ShownCell& cell) {
    auto key = cell.scene_digest + cell.scene;
    for (const auto name : {devices, model, driver, frames, handling})
        key += '|' + name_of(cell.recorded, name);
    for (const auto& bound : bounds) key += '|' + setting_of(cell.recorded, bound);
    return key;
}

/// A scene by its name where no other has the name.
const std::string& scene_of(const ShownCell& cell,
                            const std::map<std::string, std::set<std::string>>& scenes) {
    return scenes.at(cell.scene_name).size() == 1 ? cell.scene_name : cell.scene;
}

std::string title_of(const ShownCell& cell, const std::string& scene_name) {
    const auto& recorded = cell.recorded;
    auto title = fmt::format("{}, {}", scene_name, name_of(recorded, frames));
    for (const auto& bound : bounds)
        if (const auto value = setting_of(recorded, bound); value != bound.usual)
            title += fmt::format(", {} = {}", bound.name, value);
    if (const auto how = name_of(recorded, handling); !how.empty()) title += ", " + how;
    return title + fmt::format(", on {} ({})", name_of(recorded, devices), name_of(recorded, model));
}

bool takes_part(const ShownCell& cell) {
    const auto& recorded = cell.recorded;
    const bool has_pairs = !recorded.pairs || recorded.pairs->count > 0;
    return recorded.status == "ok" && !recorded.rounds.empty() && !cell.is_older && has_pairs;
}

std::vector<double> times_of(const ShownCell& cell) {
    std::vector<double> times;
    for (const auto& round : cell.recorded.rounds) times.push_back(round.ns);
    return times;
}

/// Rounds of one number of one session were taken side by side.
std::vector<double> paired_log_ratios(const RecordedCell& base, const RecordedCell& other) {
    std::vector<double> ratios;
    if (base.session.empty() || base.session != other.session) return ratios;
    std::map<std::int64_t, double> by_number;
    for (const auto& round : base.rounds) by_number[round.number] = round.ns;
    for (const auto& round : other.rounds)
        if (const auto found = by_number.find(round.number); found != by_number.end())
            ratios.push_back(std::log(round.ns / found->second));
    return ratios;
}

Place place_of(std::size_t index, const ShownCell& base, const ShownCell& cell) {
    Place place{.cell = index};
    const auto paired = paired_log_ratios(base.recorded, cell.recorded);
    place.ratio = paired.empty() ? compare::unpaired_ratio(times_of(base), times_of(cell))
                                 : compare::paired_ratio(paired);
    place.has_interval = paired.empty()
                             ? std::min(base.recorded.rounds.size(), cell.recorded.rounds.size()) > 1
                             : paired.size() > 1;
    place.is_told_apart = place.has_interval && (place.ratio.low > 1 || place.ratio.high < 1);
    return place;
}

void rank(Group& group, const std::vector<ShownCell>& cells) {
    std::vector<std::pair<double, std::size_t>> by_time;
    const std::optional<compare::Answer>* first = nullptr;
    for (const auto i : group.cells) {
        if (!takes_part(cells[i])) continue;
        by_time.emplace_back(median(times_of(cells[i])), i);
        const auto& answer = cells[i].recorded.pairs;
        if (!answer) continue;
        if (!first) first = &answer;
        group.answers_differ = group.answers_differ || *first != answer;
    }
    std::ranges::sort(by_time);
    for (const auto& [time, i] : by_time)
        group.ranked.push_back(group.ranked.empty() ? Place{.cell = i}
                                                    : place_of(i, cells[by_time.front().second], cells[i]));
}

/// What differs among all cells of a group; among algorithms with many settings of their own, what names
/// them.
void add_labels(Group& group, const std::vector<ShownCell>& cells) {
    std::vector<const RecordedCell*> recorded;
    for (const auto i : group.cells) recorded.push_back(&cells[i].recorded);
    group.labels = compare::label(recorded).of;
}

} // namespace

std::vector<Group> groups_of(const std::vector<ShownCell>& cells) {
    std::vector<Group> groups;
    std::map<std::string, std::size_t> numbers;
    std::map<std::string, std::set<std::string>> scenes;
    for (const auto& cell : cells) scenes[cell.scene_name].insert(cell.scene_digest);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto [place, is_new] = numbers.try_emplace(key_of(cells[i]), groups.size());
        if (is_new) groups.push_back({.title = title_of(cells[i], scene_of(cells[i], scenes))});
        groups[place->second].cells.push_back(i);
    }
    for (auto& group : groups) {
        rank(group, cells);
        add_labels(group, cells);
    }
    return groups;
}

} // namespace tandem::report
