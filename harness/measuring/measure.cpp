// SPDX-License-Identifier: MIT
#include "harness/measuring/measure.h"

#include "base/counted.h"
#include "base/standard_streams.h"
#include "base/statistics.h"
#include "harness/plans/key.h"
#include "harness/plans/rank_team.h"
#include "harness/record/record.h"
#include "harness/sampling/isolation/isolated_sampler.h"
#include "harness/sampling/local_sampler.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

/// Writes results: records to a file, and the rounds of unfinished cells to the file beside it.
class ResultSink {
public:
    ResultSink(RecordFile& file, Unfinished* unfinished) : file_(file), unfinished_(unfinished) {}

    /// The earlier state of a cell, by the key of the requested settings.
    CellState state(const Cell& cell, const std::string& key) {
        return unfinished_ == nullptr ? CellState() : unfinished_->state(cell, key);
    }
    /// Stores a cell that needs more rounds: its whole state, or its last round.
    void keep(const CellSampler& sampler, const std::string& key, bool whole) {
        if (unfinished_ != nullptr) unfinished_->keep(key, sampler.state(), whole);
    }
    /// Appends a record and prints the failure of its cell, if any. Returns false when it could not be
    /// written.
    bool end(const CellResult& result, const nlohmann::ordered_json& record, const std::string& failure) {
        const bool recorded = file_.append_or_report(record);
        if (!failure.empty()) print_message("tandem: {}: {}\n", describe(*result.cell), failure);
        return recorded;
    }
    bool failed() const { return file_.failed(); }

private:
    RecordFile& file_;
    Unfinished* unfinished_;
};

/// Ends a cell. A failed device affects only its own cell: the record names the failure, and other cells
/// continue.
CellResult end_cell(const Outcome& outcome, const Sampling& sampling, const Task& task, ResultSink& sink) {
    CellResult result;
    result.cell = &outcome.sampler->cell();
    result.measurement = outcome.sampler->measurement();
    result.measured = outcome.failure.empty();
    result.is_wide = !outcome.converged && !sampling.criterion.repeat;
    const bool recorded =
        !is_first(result.cell->team)
        || sink.end(result,
                    make_record(*result.cell, task.scene, task.range, result.measurement, outcome, sampling),
                    outcome.failure);
    if (!result.measured || !recorded)
        result.code = 3;
    else
        result.code = result.measurement.agreement.ok() ? 0 : 1;
    return result;
}

std::string requested_key(const Cell& cell, const Task& task) {
    return key_of(cell, cell.settings, task.scene, task.range);
}

/// The state of a cell that an earlier run began. Collective: all ranks get the state of rank 0.
CellState shared_state(const Cell& cell, CellState own) {
    if (cell.team == nullptr || !cell.team->decided(own.is_checked())) return own;
    const auto text = cell.team->decided(
        nlohmann::json{{"checked", checked_json(own)}, {"rounds", rounds_json(own, 0)}}.dump());
    if (cell.team->is_first()) return own;
    const auto json = nlohmann::json::parse(text);
    CellState state;
    take_checked(state, json.at("checked"), cell);
    take_rounds(state, json.at("rounds"));
    return state;
}

std::unique_ptr<CellSampler> make_sampler(const Cell& cell, const Task& task, References& references,
                                          ResultSink& sink) {
    auto state = shared_state(cell, sink.state(cell, requested_key(cell, task)));
    if (task.options.isolate) return std::make_unique<IsolatedSampler>(cell, task.options, std::move(state));
    return std::make_unique<LocalSampler>(cell, task.scene, task.range, references, std::move(state));
}

} // namespace

bool measure_cells(const Task& task, std::span<const Cell> cells, References& references,
                   const Measuring& measuring, RecordFile& file, const CellsListener& listener) {
    ResultSink sink(file, measuring.unfinished);
    std::vector<std::unique_ptr<CellSampler>> samplers;
    std::vector<CellSampler*> group;
    for (const auto& cell : cells)
        group.push_back(samplers.emplace_back(make_sampler(cell, task, references, sink)).get());
    RoundsListener rounds;
    std::size_t done = 0;
    rounds.later_cells = listener.later_cells;
    rounds.progress = [&](std::string_view text, std::optional<double> left) {
        listener.progress.show(fmt::format("{}/{} {}", done, cells.size(), text), left);
    };
    rounds.before_round = measuring.before_round;
    rounds.stop = [&] { return sink.failed() || measuring.stop(); };
    rounds.kept = [&](const CellSampler& sampler, bool is_first) {
        sink.keep(sampler, requested_key(sampler.cell(), task), is_first);
    };
    rounds.finished = [&](const Outcome& outcome, const Sampling& sampling) {
        ++done;
        listener.progress.clear();
        listener.ended(end_cell(outcome, sampling, task, sink));
    };
    return sample_group(group, measuring.check, measuring.stopping, measuring.seed, rounds);
}

std::string disturbed_text(std::span<const CellResult* const> results) {
    std::map<std::string, std::size_t> reasons;
    std::size_t disturbed = 0, all = 0;
    for (const auto* result : results)
        for (const auto& round : result->measurement.conditions) {
            ++all;
            if (const auto reason = round.disturbed()) ++disturbed, ++reasons[*reason];
        }
    if (disturbed == 0) return {};
    const auto most = std::ranges::max_element(reasons, {}, [](const auto& entry) { return entry.second; });
    return fmt::format("{} of {} rounds were disturbed ({})", disturbed, all, most->first);
}

std::string doubts(std::span<const CellResult* const> results) {
    std::size_t wide = 0, outliers = 0;
    std::pair<double, const Cell*> most; // drift
    for (const auto* result : results) {
        wide += result->is_wide ? 1 : 0;
        const auto rounds = round_medians(result->measurement.totals(), result->measurement.rounds());
        outliers += count_outliers(rounds);
        if (const auto change = drift(rounds); change && std::abs(*change) > std::abs(most.first))
            most = {*change, result->cell};
    }
    std::vector<std::string> notes;
    if (wide > 0)
        notes.push_back(results.size() == 1 ? "the interval is wider than asked for"
                                            : fmt::format("{} of {} intervals are wider than asked for", wide,
                                                          results.size()));
    if (outliers > 0) notes.push_back(counted(outliers, "outlier"));
    if (most.second != nullptr)
        notes.push_back(
            fmt::format("drift of up to {:+.1f} % ({})", most.first * 100, describe(*most.second)));
    return fmt::to_string(fmt::join(notes, "; "));
}

} // namespace tandem
