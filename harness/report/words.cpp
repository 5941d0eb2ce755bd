// SPDX-License-Identifier: MIT
#include "harness/report/groups.h"
#include "harness/statistics.h"
#include "harness/text_lines.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace tandem::report {

namespace {

/// Three digits, no more: of a ratio or of milliseconds.
std::string digits(double value) {
    const int decimals = value < 0.01 ? 5 : value < 0.1 ? 4 : value < 10 ? 3 : value < 100 ? 1 : 0;
    return fmt::format("{:.{}f}", value, decimals);
}

std::string label_of(const Group& group, std::size_t cell) {
    const auto place = std::ranges::find(group.cells, cell) - group.cells.begin();
    return one_line(group.labels[static_cast<std::size_t>(place)], 300);
}

/// The median of a cell's rounds, a frame.
double milliseconds(const ShownCell& cell) {
    std::vector<double> times;
    for (const auto& round : cell.recorded.rounds) times.push_back(round.ns);
    return median(times) / cell.frames / 1e6;
}

std::string held_against(const Place& place) {
    if (!place.has_interval)
        return fmt::format("takes {} times as long, in one round: how sure is not known",
                           digits(place.ratio.value));
    const auto interval = fmt::format("[{}, {}]", digits(place.ratio.low), digits(place.ratio.high));
    if (!place.is_told_apart)
        return fmt::format("is not told apart from it ({} times its time {})", digits(place.ratio.value),
                           interval);
    return fmt::format("takes {} times as long {}", digits(place.ratio.value), interval);
}

std::string fastest_words(const Group& group, const std::vector<ShownCell>& cells) {
    const auto& ranked = group.ranked;
    const auto ms = digits(milliseconds(cells[ranked[0].cell]));
    const auto name = label_of(group, ranked[0].cell);
    if (ranked.size() == 1)
        return fmt::format("{} takes {} ms a frame; there is nothing to compare it with.", name, ms);
    auto text = fmt::format("{} is the fastest of {} with {} ms a frame; the next, {}, {}.", name,
                            ranked.size(), ms, label_of(group, ranked[1].cell), held_against(ranked[1]));
    if (ranked.size() > 2)
        text += fmt::format(" The slowest, {}, {}.", label_of(group, ranked.back().cell),
                            held_against(ranked.back()));
    return text;
}

/// "3 failed and 1 was wrong", with the first of each named.
std::string not_ranked(const Group& group, const std::vector<ShownCell>& cells) {
    std::string text;
    for (const auto i : group.cells) {
        const auto& cell = cells[i].recorded;
        if (cell.status == "ok") continue;
        const auto why = cell.status == "failed" ? ": " + one_line(cell.failure, 200)
                                                 : ": its answer is not the reference's";
        text += fmt::format(" {} {}, and is not ranked{}.", label_of(group, i),
                            cell.status == "failed" ? "failed" : "was wrong", why);
        if (text.size() > 900) return text + " There are more.";
    }
    return text;
}

/// How often an algorithm is the fastest, and how often the next is told apart.
struct Wins {
    std::size_t all = 0, sure = 0;
    double least = 0, most = 0; ///< by how much the best of another algorithm is slower, where there is one
};

void count_win(const Group& group, const std::vector<ShownCell>& cells, std::map<std::string, Wins>& wins) {
    const auto algorithm_of = [&](const Place& place) { return cells[place.cell].recorded.names[0].second; };
    const auto winner = algorithm_of(group.ranked[0]);
    const auto next =
        std::ranges::find_if(group.ranked, [&](const Place& p) { return algorithm_of(p) != winner; });
    if (next == group.ranked.end()) return;
    auto& of = wins[winner];
    of.least = of.all == 0 ? next->ratio.value : std::min(of.least, next->ratio.value);
    of.most = std::max(of.most, next->ratio.value);
    ++of.all;
    of.sure += next->is_told_apart ? 1 : 0;
}

std::string wins_text(const std::map<std::string, Wins>& wins, std::size_t contested) {
    std::vector<std::pair<std::string, Wins>> order(wins.begin(), wins.end());
    std::ranges::stable_sort(order, [](const auto& a, const auto& b) { return a.second.all > b.second.all; });
    std::vector<std::string> parts;
    parts.reserve(order.size());
    for (const auto& [name, won] : order)
        parts.push_back(
            fmt::format("{} is the fastest in {} of {} comparisons, told apart from the best other "
                        "algorithm in {}, which takes {}{} times as long",
                        one_line(name, 100), won.all, contested, won.sure, digits(won.least),
                        won.all > 1 ? " to " + digits(won.most) : ""));
    return fmt::format("{}.", fmt::join(parts, "; "));
}

} // namespace

std::string words_of(const Group& group, const std::vector<ShownCell>& cells) {
    std::string text;
    if (group.ranked.empty())
        text = "None of its cells has times that count.";
    else if (group.answers_differ)
        text = "Its cells found different sets of candidate pairs, so that times are of different work: none "
               "is said "
               "to be the fastest.";
    else
        text = fastest_words(group, cells);
    return text + not_ranked(group, cells);
}

std::vector<std::string> words_of(const std::vector<Group>& groups, const std::vector<ShownCell>& cells) {
    std::map<std::string, Wins> wins;
    for (const auto& group : groups)
        if (!group.ranked.empty() && !group.answers_differ) count_win(group, cells, wins);
    std::vector<std::string> words;
    std::size_t contested = 0;
    for (const auto& [name, won] : wins) contested += won.all;
    if (contested > 0) words.push_back(wins_text(wins, contested));
    const auto count = [&](std::string_view status) {
        return std::ranges::count(cells, status, [](const auto& cell) { return cell.recorded.status; });
    };
    const auto failed = count("failed");
    const auto wrong = count("wrong");
    if (failed + wrong > 0)
        words.push_back(fmt::format("{} failed and {} gave a wrong answer: they are shown as such and never "
                                    "ranked.",
                                    failed, wrong));
    const auto older = std::ranges::count(cells, true, &ShownCell::is_older);
    if (older > 0)
        words.push_back(
            fmt::format("{} were recorded again later: the last record that is ok counts.", older));
    const bool on_processors = std::ranges::any_of(cells, [](const auto& c) { return !c.recorded.on_gpus; });
    if (on_processors) words.push_back("Times of processors say nothing of a GPU.");
    return words;
}

} // namespace tandem::report
