// SPDX-License-Identifier: MIT
#include "harness/record/verdict.h"

#include "harness/program/environment.h"
#include "harness/record/record.h"
#include "harness/record/schema.h"
#include "base/columns.h"
#include "harness/fields/types.h"
#include "harness/plans/cell_session.h"
#include "base/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tandem {

namespace {

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

/// The cells of `order`, compared with `fastest`, which is the first; the others by their ratios.
std::vector<RankedCell> ranked_to(std::size_t fastest, std::span<const Row> rows,
                                  const std::vector<std::size_t>& order) {
    std::vector<RankedCell> cells;
    for (const auto row : order) {
        auto& cell = cells.emplace_back(compared(*rows[row].measurement, *rows[fastest].measurement));
        cell.row = row;
        cell.median_ns = median_ns(*rows[row].measurement);
    }
    std::ranges::stable_sort(
        cells, {}, [&](const RankedCell& cell) { return std::pair(cell.row != fastest, cell.ratio.value); });
    return cells;
}

/// The cell with the lowest median is the fastest, unless another one is faster by the median of ratios,
/// which are those that the sentence states. The number of steps is limited, because the ratios of three
/// cells can form a circle.
Verdict verdict_of(std::span<const Row> rows, std::vector<std::size_t> group) {
    std::ranges::sort(group, {}, [&](std::size_t row) {
        return std::pair(median_ns(*rows[row].measurement), std::string_view(rows[row].key));
    });
    Verdict verdict;
    auto fastest = group.front();
    for (std::size_t step = 0; step < group.size(); ++step) {
        verdict.cells = ranked_to(fastest, rows, group);
        if (verdict.cells[1].ratio.value >= 1) break;
        fastest = verdict.cells[1].row;
    }
    const auto& digest = rows[group.front()].measurement->agreement.digest;
    verdict.answers_differ = std::ranges::any_of(
        group, [&](std::size_t row) { return rows[row].measurement->agreement.digest != digest; });
    return verdict;
}

/// The body pairs among which a cell finds pairs: all that may meet, or those of boxes of spheres or a part
/// of these. Cells of different ones do different work.
std::array<std::string, 3> body_pairs_of(const SettingTexts& settings) {
    const auto value = [&](const char* name) {
        const auto found = settings.find(name);
        return found == settings.end() ? "0" : found->second;
    };
    const bool within_boxes = value("broad") == "sphere_boxes";
    return {within_boxes ? "boxes" : "all", value("first_body_pair"), value("most_body_pairs")};
}

std::string interval_text(const RankedCell& cell) {
    return fmt::format("[{:.3g}, {:.3g}]", cell.ratio.low, cell.ratio.high);
}

/// "A and B cannot be told apart", of all cells that nothing tells apart from the first.
std::string not_told_apart(const Verdict& verdict, std::span<const std::string> labels) {
    std::vector<std::string> names;
    for (const auto& cell : verdict.cells)
        if (verdict.is_leader(cell)) names.push_back(labels[cell.row]);
    const auto last = names.back();
    names.pop_back();
    const auto& next = verdict.cells[1];
    return fmt::format("{} and {} cannot be told apart with {} rounds (ratio {}); try --repeat {}",
                       fmt::join(names, ", "), last, next.rounds, interval_text(next), 4 * next.rounds);
}

} // namespace

bool comparable(const Row& a, const Row& b) {
    const auto is_eligible = [](const Row& row) {
        return row.measurement->agreement.ok() && pairs_of(*row.measurement) > 0;
    };
    if (!is_eligible(a) || !is_eligible(b) || a.cell->devices != b.cell->devices) return false;
    const auto x = a.measurement->settings.texts(), y = b.measurement->settings.texts();
    if (body_pairs_of(x) != body_pairs_of(y)) return false;
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
        return fmt::format("{} cells found different sets of candidate pairs: none counts as the fastest.",
                           verdict.cells.size());
    const auto &first = verdict.cells[0], &next = verdict.cells[1], &last = verdict.cells.back();
    const auto frames = static_cast<double>(rows[first.row].measurement->candidate_pairs.size());
    const auto ms = milliseconds(first.median_ns * 1e-6 / frames);
    std::string text;
    if (!next.has_interval())
        text = fmt::format(
            "{} took the least time, in fewer than 5 rounds: {} ms per frame, {:.3g} times as fast as {}; "
            "--repeat 5 gives an interval",
            label(first), ms, next.ratio.value, label(next));
    else if (!next.is_told_apart())
        text = not_told_apart(verdict, labels);
    else
        text = fmt::format("{} is fastest: {} ms per frame, {:.3g} times as fast as {} {}", label(first), ms,
                           next.ratio.value, label(next), interval_text(next));
    if (last.is_told_apart() && &last != &next)
        text += fmt::format(". The slowest, {}, takes {:.3g} times as long {}", label(last), last.ratio.value,
                            interval_text(last));
    return text + ".";
}

std::string verdict_scope(const Verdict& verdict, std::span<const Verdict> all, std::span<const Row> rows) {
    const auto first = [&](const Verdict& one) -> const Row& { return rows[one.cells.front().row]; };
    const auto differs = [&](const auto& of) {
        return std::ranges::any_of(all,
                                   [&](const Verdict& one) { return of(first(one)) != of(first(verdict)); });
    };
    std::vector<std::string> settings;
    for (const auto* name : compared_settings) {
        const auto value = [&](const Row& row) {
            const auto texts = row.measurement->settings.texts();
            const auto found = texts.find(name);
            return found == texts.end() ? std::string() : found->second;
        };
        if (differs(value)) settings.push_back(fmt::format("{}={}", name, value(first(verdict))));
    }
    const auto devices = [](const Row& row) { return name_of(row.cell->devices); };
    if (differs(devices)) settings.push_back(devices(first(verdict)));
    return settings.empty() ? std::string() : fmt::format("{}: ", fmt::join(settings, ", "));
}

} // namespace tandem

namespace tandem::record_parts {

namespace {

/// What the fields of a line are taken from.
struct VerdictLine {
    const Verdict& verdict;
    std::span<const Row> rows;
    const Scene& scene;
    const FrameRange& range;

    const Row& first() const { return rows[verdict.cells.front().row]; }
};

struct RankedRow {
    const RankedCell& cell;
    const Row& row;

    /// Null for fewer than five rounds.
    template<class Value>
    Json with_interval(Value value) const {
        return cell.has_interval() ? Json(value) : Json();
    }
};

const Fields<RankedRow>& ranked_fields() {
    static const Fields<RankedRow> fields{
        {"key", text(), "of the cell's record", [](auto& r) { return r.row.key; }},
        {"chosen", boolean(), "the cell is one of --algorithm auto",
         [](auto& r) { return r.row.cell->chosen != nullptr; }},
        {"median_ns", number_above(0), "nanoseconds of a replay of all frames, median of the rounds' medians",
         [](auto& r) { return r.cell.median_ns; }},
        {"rounds", count(), "rounds in which both this cell and the fastest were measured",
         [](auto& r) { return r.cell.rounds; }},
        {"ratio", number_above(0),
         "time of this cell to that of the fastest: median of the ratios of those rounds",
         [](auto& r) { return r.cell.ratio.value; }},
        {"low", nullable(number_above(0)), "lower end of its 95 % interval; null for fewer than five rounds",
         [](auto& r) { return r.with_interval(r.cell.ratio.low); }},
        {"high", nullable(number_above(0)), "upper end",
         [](auto& r) { return r.with_interval(r.cell.ratio.high); }},
        {"told_apart", nullable(boolean()), "whether the interval excludes 1; null without one",
         [](auto& r) { return r.with_interval(r.cell.is_told_apart()); }}};
    return fields;
}

const Fields<Scene>& verdict_scene_fields() {
    static const Fields<Scene> fields{{"key", text(), "name and every parameter", &Scene::key},
                                      {"digest", hex(), "64-bit digest of meshes, bodies and motion",
                                       [](auto& s) { return hex_text(s.digest); }}};
    return fields;
}

Json device_ids_json(const VerdictLine& v) {
    Json ids = Json::array();
    for (const auto& info : infos_of(*v.first().cell)) ids.push_back(info.id);
    return ids;
}

Json bounds_json(const VerdictLine& v) {
    Json bounds = Json::object();
    const auto settings = v.first().measurement->settings.texts();
    for (const auto* name : compared_settings)
        if (const auto found = settings.find(name); found != settings.end()) bounds[name] = found->second;
    return bounds;
}

Json ranked_json(const VerdictLine& v) {
    std::vector<RankedRow> rows;
    for (const auto& cell : v.verdict.cells) rows.push_back({cell, v.rows[cell.row]});
    return array_json(ranked_fields(), rows);
}

const Fields<VerdictLine>& verdict_fields() {
    static const Fields<VerdictLine> fields{
        {"schema", constant(record_schema), "version of this schema, which is that of records of cells",
         [](auto&) { return record_schema; }},
        {"kind", constant("verdict"), "distinguishes this line from a record of a cell",
         [](auto&) { return "verdict"; }},
        {"session", pattern_of_digest(), "of the run, as in the records of its cells",
         [](auto&) { return session_id(); }},
        {"scene", verdict_scene_fields().type("what was collided"), "",
         [](auto& v) { return verdict_scene_fields().write(v.scene); }},
        {"frames", frames_fields().type("range of frames that a sample replays once"), "",
         [](auto& v) {
             return frames_fields().write({v.range.first(), v.range.last()});
         }},
        {"devices", array_of(text()).with("minItems", 1), "ids of the devices of each cell", device_ids_json},
        {"bounds", map_of(any_text().with("description", "value of the setting"), ""),
         "the settings that all cells share because they determine the work: k, axes, precision, rounding, "
         "placement, origin and output, as far as the algorithms have them",
         bounds_json},
        {"answers_differ", boolean(),
         "the cells were not checked, and found different candidate pairs: none is the fastest",
         [](auto& v) { return v.verdict.answers_differ; }},
        {"cells", array_of(ranked_fields().type("")).with("minItems", 2),
         "the fastest first, the others by their ratio", ranked_json}};
    return fields;
}

} // namespace

Type verdict_type() {
    return verdict_fields().type("Which of several comparable cells is the fastest, and which others are "
                                 "told apart from it. 'tandem run' "
                                 "appends one behind the records of the cells that it measured together, for "
                                 "each set of at least two cells of "
                                 "equal scene, frames, devices and bounds with a correct answer and "
                                 "candidate pairs. One object a line; "
                                 "unknown is null. Other lines of the file are records of cells.");
}

} // namespace tandem::record_parts

namespace tandem {

nlohmann::ordered_json verdict_record(const Verdict& verdict, std::span<const Row> rows, const Scene& scene,
                                      const FrameRange& range) {
    return record_parts::verdict_fields().write({verdict, rows, scene, range});
}

} // namespace tandem
