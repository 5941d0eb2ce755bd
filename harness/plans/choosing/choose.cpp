// SPDX-License-Identifier: MIT
#include "harness/plans/choosing/choose.h"

#include "harness/plans/choosing/trials.h"
#include "base/standard_streams.h"
#include "harness/sampling/ranks/rank_team.h"
#include "harness/sampling/statistics.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// Preparation gets more time than replays: a GPU compiler takes a second or two, a frame about a
/// millisecond.
constexpr double preparing_per_measuring = 6;

Choice::Candidate timed(const Cell& cell, const std::vector<std::int64_t>& replays, std::string failure) {
    auto candidate = named(cell);
    if (!replays.empty()) candidate.median_ns = median(replays);
    candidate.replays = replays.size();
    candidate.failure = std::move(failure);
    return candidate;
}

/// The candidates in the order of Choice::candidates.
std::vector<Choice::Candidate> ordered(const Cell& cell, const SearchResult& found, const Trials& trials) {
    auto order = found.ranking;
    for (const bool failed : {true, false})
        for (std::size_t i = 0; i < cell.candidates.size(); ++i)
            if (trials.failure(i).empty() != failed
                && std::find(found.ranking.begin(), found.ranking.end(), i) == found.ranking.end())
                order.push_back(i);
    std::vector<Choice::Candidate> all;
    all.reserve(order.size());
    for (const auto i : order) all.push_back(timed(cell.candidates[i], found.replays[i], trials.failure(i)));
    return all;
}

/// Searches for the fastest candidate; none when every candidate failed.
std::optional<Choice> compare(const Cell& cell, Trials& trials, const ChoosingOptions& options) {
    SearchSteps steps;
    steps.replay = [&](std::size_t i) {
        options.progress(fmt::format("auto: candidate {} of {}: {}", i + 1, cell.candidates.size(),
                                     describe(cell.candidates[i])));
        return trials.replay(i);
    };
    steps.measured = [&] { return trials.measured_seconds(); };
    steps.preparing = [&] { return trials.preparing_seconds(); };
    steps.drop = [&](std::size_t i) { trials.drop(i); };
    const auto found =
        search(cell.candidates.size(), steps, {options.seconds, preparing_per_measuring * options.seconds});
    if (found.ranking.empty()) return std::nullopt;
    Choice choice;
    choice.candidates = ordered(cell, found, trials);
    choice.seconds = trials.measured_seconds();
    choice.preparing = trials.preparing_seconds();
    return choice;
}

/// Replaces the cell by the chosen candidate. Returns false when no candidate has that name any more.
bool settle(Cell& cell, const Choice& choice) {
    const auto chosen =
        std::find_if(cell.candidates.begin(), cell.candidates.end(),
                     [&](const auto& candidate) { return names(choice.candidates.front(), candidate); });
    if (chosen == cell.candidates.end()) return false;
    auto decided = *chosen;
    decided.chosen = std::make_shared<const Choice>(choice);
    cell = std::move(decided);
    return true;
}

std::string describe(const Choice::Candidate& candidate) {
    std::string text = candidate.algorithm + " " + candidate.preset;
    char before = ' ';
    for (const auto& [name, value] : candidate.settings) {
        text += fmt::format("{}{}={}", before, name, value);
        before = ',';
    }
    return text;
}

/// "best of 14 candidates, 12 % ahead of NEXT".
std::string lead(const Choice& choice) {
    const auto margin = choice.margin();
    const auto tried = std::count_if(choice.candidates.begin(), choice.candidates.end(),
                                     [](const auto& candidate) { return candidate.median_ns.has_value(); });
    auto text = fmt::format("best of {} candidates", choice.candidates.size());
    if (static_cast<std::size_t>(tried) < choice.candidates.size()) text += fmt::format(" ({} timed)", tried);
    return margin
               ? fmt::format("{}, {:.1f} % ahead of {}", text, *margin * 100, describe(*choice.runner_up()))
               : text;
}

void print_choice(const Cell& cell, double limit, const std::filesystem::path& file) {
    const auto& choice = *cell.chosen;
    if (choice.from_cache)
        print_message("auto: {}, stored in {}: {} on {}; --choose-afresh measures again\n", describe(cell),
                      file.string(), lead(choice), choice.scene);
    else
        print_message("auto: {}: {} on frames {}:{}, in {:.1f} s of replays (at most {:g}) and {:.1f} s of "
                      "preparation\n",
                      describe(cell), lead(choice), choice.first, choice.last, choice.seconds, limit,
                      choice.preparing);
}

void warn(const std::string& line) {
    if (!line.empty()) print_message("tandem: {}\n", line);
}

/// Candidate pairs a frame, from the first candidate that works: all candidates find the same number.
std::uint64_t pairs_of_a_frame(const Cell& cell, Trials& trials, std::size_t frames) {
    for (std::size_t i = 0; i < cell.candidates.size(); ++i)
        if (trials.prepare(i)) break;
    return trials.pairs() / frames;
}

/// Throws InputError unless the ranks of a job have the same candidates.
void check_same_candidates(const Cell& cell) {
    if (cell.team == nullptr) return;
    std::string all;
    for (const auto& candidate : cell.candidates) all += describe(candidate) + "\n";
    cell.team->check_same(all);
}

/// The choice of rank 0 on all ranks.
std::optional<Choice> choice_of_first(RankTeam* team, const std::optional<Choice>& own) {
    if (team == nullptr) return own;
    const auto text = team->decided(own ? choice_json(*own).dump() : std::string());
    return text.empty() ? std::nullopt : std::optional(choice_of(nlohmann::ordered_json::parse(text)));
}

} // namespace

void choose(Cell& cell, const Scene& scene, const FrameRange& range, const ChoosingOptions& options) {
    if (cell.candidates.empty()) return;
    auto* team = cell.team;
    const auto frames = std::min(range.size(), most_choosing_frames);
    const ChoiceCache cache(is_first(team) ? options.folder : std::filesystem::path(), program_version());
    const auto undecided = cell; // a copy, because sessions refer to its candidates
    check_same_candidates(undecided);
    options.progress(fmt::format("auto: {} candidates", undecided.candidates.size()));
    Trials trials(undecided.candidates, scene, range, frames, options.stop);
    const auto question = question_of(undecided, scene, pairs_of_a_frame(undecided, trials, frames));
    std::string warning;
    auto choice = choice_of_first(team, options.afresh ? std::nullopt : cache.find(question, warning));
    if (choice && settle(cell, *choice)) {
        auto kept = *choice;
        kept.from_cache = true;
        cell.chosen = std::make_shared<const Choice>(kept);
    } else if ((choice = compare(undecided, trials, options))) {
        choice->scene = scene.key;
        choice->first = range.first();
        choice->last = range.first() + frames - 1;
        settle(cell, *choice);
    }
    options.progress("");
    warn(warning);
    if (!cell.chosen) return;
    if (!cell.chosen->from_cache) warn(cache.keep(question, *cell.chosen));
    print_choice(cell, options.seconds, cache.file_of(question));
}

} // namespace tandem
