// SPDX-License-Identifier: MIT
#include "harness/record/verdict.h"

#include "harness/record/environment.h"
#include "harness/record/record.h"
#include "harness/record/table/columns.h"
#include "harness/sampling/ranks/rank_team.h"
#include "harness/sampling/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tandem {

namespace {

using Json = nlohmann::ordered_json;

/// What cells must share to be compared, besides scene, frames and devices.
constexpr std::array compared_settings{"k", "axes", "precision", "rounding", "placement", "origin", "output"};

std::uint64_t pairs_of(const Measurement& m) {
    return std::accumulate(m.candidate_pairs.begin(), m.candidate_pairs.end(), std::uint64_t{0});
}

/// Medians by the number of their round.
std::map<std::uint32_t, double> medians_by_round(const Measurement& m) {
    const auto rounds = m.rounds();
    const auto medians = round_medians(m.totals(), rounds);
    std::map<std::uint32_t, double> result;
    for (const auto round : rounds) result.emplace(round, 0);
    auto next = medians.begin();
    for (auto& [round, median] : result) median = *next++;
    return result;
}

/// The group of comparable rows that begins with `first`.
std::vector<std::size_t> group_of(std::span<const Row> rows, std::size_t first) {
    std::vector<std::size_t> group;
    for (std::size_t i = first; i < rows.size(); ++i)
        if (!rows[i].measurement->samples.empty() && (i == first || comparable(rows[first], rows[i])))
            group.push_back(i);
    return group;
}

Verdict verdict_of(std::span<const Row> rows, const std::vector<std::size_t>& group) {
    Verdict verdict;
    std::vector<std::pair<double, std::size_t>> order;
    for (const auto row : group) order.emplace_back(median_ns(*rows[row].measurement), row);
    std::ranges::sort(order, [&](const auto& a, const auto& b) {
        return std::tie(a.first, rows[a.second].key) < std::tie(b.first, rows[b.second].key);
    });
    const auto& fastest = *rows[order.front().second].measurement;
    for (const auto& [median, row] : order) {
        const auto& m = *rows[row].measurement;
        auto& cell = verdict.cells.emplace_back(compared(m, fastest));
        cell.row = row;
        cell.median_ns = median;
        verdict.answers_differ |= m.agreement.digest != fastest.agreement.digest;
    }
    return verdict;
}

std::string ratio_text(const RankedCell& cell) {
    const auto& ratio = cell.ratio;
    if (!cell.has_interval())
        return fmt::format("takes {:.3g} times as long (one round: no interval)", ratio.value);
    const auto interval = fmt::format("[{:.3g}, {:.3g}]", ratio.low, ratio.high);
    if (!cell.is_told_apart())
        return fmt::format("is not told apart from it ({:.3g} times its time {})", ratio.value, interval);
    return fmt::format("takes {:.3g} times as long {}", ratio.value, interval);
}

} // namespace

bool comparable(const Row& a, const Row& b) {
    const auto is_eligible = [](const Row& row) {
        return row.measurement->agreement.ok() && pairs_of(*row.measurement) > 0;
    };
    if (!is_eligible(a) || !is_eligible(b) || a.cell->devices != b.cell->devices) return false;
    const auto x = a.measurement->settings.texts(), y = b.measurement->settings.texts();
    return std::ranges::all_of(compared_settings, [&](const char* name) {
        const auto i = x.find(name), j = y.find(name);
        return (i == x.end()) == (j == y.end()) && (i == x.end() || i->second == j->second);
    });
}

bool Verdict::is_leader(const RankedCell& cell) const {
    return !answers_differ && (&cell == &cells.front() || (cell.has_interval() && !cell.is_told_apart()));
}

RankedCell compared(const Measurement& m, const Measurement& fastest) {
    const auto above = medians_by_round(m), below = medians_by_round(fastest);
    std::vector<double> logs;
    for (const auto& [round, ns] : above)
        if (const auto found = below.find(round); found != below.end())
            logs.push_back(std::log(ns / found->second));
    RankedCell cell;
    cell.rounds = logs.size();
    const auto value = median_ns(m) / median_ns(fastest);
    cell.ratio = logs.empty() ? Ratio{value, value, value} : paired_ratio(logs);
    return cell;
}

std::vector<Verdict> verdicts_of(std::span<const Row> rows) {
    std::vector<Verdict> verdicts;
    std::vector<bool> is_grouped(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (is_grouped[i] || rows[i].measurement->samples.empty()) continue;
        const auto group = group_of(rows, i);
        for (const auto row : group) is_grouped[row] = true;
        if (group.size() > 1) verdicts.push_back(verdict_of(rows, group));
    }
    return verdicts;
}

std::string verdict_sentence(const Verdict& verdict, std::span<const Row> rows,
                             std::span<const std::string> labels) {
    const auto label = [&](const RankedCell& cell) { return labels[cell.row]; };
    if (verdict.answers_differ)
        return fmt::format("{} cells found different sets of candidate pairs: none counts as the fastest",
                           verdict.cells.size());
    const auto &first = verdict.cells[0], &next = verdict.cells[1], &last = verdict.cells.back();
    const auto frames = rows[first.row].measurement->candidate_pairs.size();
    auto text = fmt::format(
        "{} {} of {} with {} ms a frame; the next, {}, {}.", label(first),
        next.is_told_apart() ? "is the fastest" : "has the lowest median", verdict.cells.size(),
        milliseconds(first.median_ns * 1e-6 / static_cast<double>(frames)), label(next), ratio_text(next));
    if (verdict.cells.size() > 2) text += fmt::format(" The slowest, {}, {}.", label(last), ratio_text(last));
    return text;
}

Json verdict_record(const Verdict& verdict, std::span<const Row> rows, const Scene& scene,
                    const FrameRange& range) {
    const auto& first = rows[verdict.cells.front().row];
    Json devices = Json::array(), bounds = Json::object(), cells = Json::array();
    for (const auto& info : infos_of(*first.cell)) devices.push_back(info.id);
    const auto settings = first.measurement->settings.texts();
    for (const auto* name : compared_settings)
        if (const auto found = settings.find(name); found != settings.end()) bounds[name] = found->second;
    for (const auto& cell : verdict.cells) {
        const bool is_known = cell.has_interval();
        cells.push_back({{"key", rows[cell.row].key},
                         {"chosen", rows[cell.row].cell->chosen != nullptr},
                         {"median_ns", cell.median_ns},
                         {"rounds", cell.rounds},
                         {"ratio", cell.ratio.value},
                         {"low", is_known ? Json(cell.ratio.low) : Json()},
                         {"high", is_known ? Json(cell.ratio.high) : Json()},
                         {"told_apart", is_known ? Json(cell.is_told_apart()) : Json()}});
    }
    return {{"schema", record_schema},
            {"kind", "verdict"},
            {"session", session_id()},
            {"scene", {{"key", scene.key}, {"digest", fmt::format("{:016x}", scene.digest)}}},
            {"frames", {{"first", range.first()}, {"last", range.last()}}},
            {"devices", devices},
            {"bounds", bounds},
            {"answers_differ", verdict.answers_differ},
            {"cells", cells}};
}

} // namespace tandem
