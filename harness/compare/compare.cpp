// SPDX-License-Identifier: MIT
#include "harness/compare/compare.h"

#include "harness/compare/holm.h"
#include "harness/compare/nothing_common.h"
#include "harness/statistics.h"
#include "scenes/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tandem::compare {

namespace {

bool same(const std::optional<Answer>& before, const std::optional<Answer>& after) {
    return !before || !after || *before == *after;
}

std::vector<double> times_of(const RecordedCell& cell) {
    std::vector<double> times;
    for (const auto& round : cell.rounds) times.push_back(round.ns);
    return times;
}

/// Times of the rounds that both have, in order.
std::pair<std::vector<double>, std::vector<double>> common_times(const RecordedCell& before,
                                                                 const RecordedCell& after) {
    std::pair<std::vector<double>, std::vector<double>> times;
    auto other = after.rounds.begin();
    for (const auto& round : before.rounds) {
        while (other != after.rounds.end() && other->number < round.number) ++other;
        if (other == after.rounds.end() || other->number != round.number) continue;
        times.first.push_back(round.ns);
        times.second.push_back(other->ns);
    }
    return times;
}

void compare_paired(ComparedCell& cell, const std::vector<double>& before, const std::vector<double>& after) {
    std::vector<double> log_ratios;
    for (std::size_t i = 0; i < before.size(); ++i) log_ratios.push_back(std::log(after[i] / before[i]));
    cell.ratio = paired_ratio(log_ratios);
    cell.test = signed_rank_test(log_ratios);
    cell.least_p = least_signed_rank_p(before.size());
}

void compare_unpaired(ComparedCell& cell, const std::vector<double>& before,
                      const std::vector<double>& after) {
    cell.ratio = unpaired_ratio(before, after);
    cell.test = rank_sum_test(before, after);
    cell.least_p = least_rank_sum_p(before.size(), after.size());
}

double default_threshold(const RecordedCell& before, const RecordedCell& after) {
    return before.on_gpus && after.on_gpus ? 0.01 : 0.03;
}

ComparedCell compare_cell(const RecordedCell& before, const RecordedCell& after, const Options& options) {
    ComparedCell cell;
    cell.before = &before;
    cell.after = &after;
    cell.threshold = options.threshold.value_or(default_threshold(before, after));
    auto times = common_times(before, after);
    cell.common = times.first.size();
    cell.paired = !before.session.empty() && before.session == after.session && cell.common > 0;
    if (!cell.paired) times = {times_of(before), times_of(after)};
    cell.before_ns = median(times.first);
    cell.after_ns = median(times.second);
    if (!same(before.pairs, after.pairs) || !same(before.contacts, after.contacts))
        cell.verdict = Verdict::another_answer;
    else if (cell.paired)
        compare_paired(cell, times.first, times.second);
    else
        compare_unpaired(cell, times.first, times.second);
    return cell;
}

/// Rounds a side with which a cell could be shown to have changed among so many.
std::size_t rounds_needed(bool paired, double level, std::size_t cells) {
    const auto least = [&](std::size_t n) {
        return paired ? least_signed_rank_p(n) : least_rank_sum_p(n, n);
    };
    std::size_t rounds = 1;
    while (rounds < 1000 && least(rounds) * static_cast<double>(cells) >= level) ++rounds;
    return rounds;
}

Verdict verdict_of(const ComparedCell& cell, double level) {
    if (*cell.p >= level) return Verdict::not_shown;
    if (cell.ratio.value > 1 + cell.threshold) return Verdict::slower;
    if (cell.ratio.value < 1 / (1 + cell.threshold)) return Verdict::faster;
    return Verdict::within_threshold;
}

/// Corrects p-values over `tested` and says what they show. That too few rounds are too few is said of what
/// the correction would leave of the least p-values of all: each corrected p-value grows with every p-value.
void decide(std::span<ComparedCell* const> tested, double level) {
    std::vector<double> p;
    std::vector<double> least;
    for (const auto* cell : tested) {
        p.push_back(cell->test.p);
        least.push_back(cell->least_p);
    }
    const auto corrected = holm(p);
    const auto least_corrected = holm(least);
    for (std::size_t i = 0; i < tested.size(); ++i) {
        auto& cell = *tested[i];
        cell.p = corrected[i];
        if (least_corrected[i] >= level) {
            cell.verdict = Verdict::too_few;
            continue;
        }
        cell.verdict = verdict_of(cell, level);
        cell.least_effect =
            least_effect(cell.ratio.log_error, level / static_cast<double>(tested.size()), power);
    }
}

/// Cells by their keys, each compared by itself.
Comparison match(const RecordedCells& before, const RecordedCells& after, const Options& options) {
    Comparison comparison;
    std::map<std::string_view, const RecordedCell*> by_key;
    for (const auto& cell : after.cells) by_key.emplace(cell.key, &cell);
    for (const auto& cell : before.cells) {
        const auto found = by_key.find(cell.key);
        if (found == by_key.end()) {
            comparison.only_old.push_back(&cell);
            continue;
        }
        comparison.cells.push_back(compare_cell(cell, *found->second, options));
        by_key.erase(found);
    }
    for (const auto& cell : after.cells)
        if (by_key.contains(cell.key)) comparison.only_new.push_back(&cell);
    return comparison;
}

} // namespace

std::size_t Comparison::count(Verdict verdict) const {
    return static_cast<std::size_t>(std::ranges::count(cells, verdict, &ComparedCell::verdict));
}

bool Comparison::changed() const {
    return count(Verdict::slower) + count(Verdict::faster) + count(Verdict::another_answer) > 0;
}

Comparison compare(const RecordedCells& before, const RecordedCells& after, const Options& options) {
    auto comparison = match(before, after, options);
    if (comparison.cells.empty()) throw InputError(why_nothing_common(before, after));
    std::vector<ComparedCell*> tested;
    for (auto& cell : comparison.cells) {
        if (cell.verdict == Verdict::another_answer) continue;
        cell.verdict = Verdict::too_few;
        if (cell.least_p < options.level) tested.push_back(&cell);
    }
    comparison.tested = tested.size();
    decide(tested, options.level);
    const auto timed = comparison.cells.size() - comparison.count(Verdict::another_answer);
    for (auto& cell : comparison.cells)
        if (cell.verdict == Verdict::too_few)
            cell.rounds_needed = rounds_needed(cell.paired, options.level, timed);
    return comparison;
}

} // namespace tandem::compare
