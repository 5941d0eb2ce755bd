// SPDX-License-Identifier: MIT
#include "harness/record/table/table.h"

#include "harness/plans/cell_session.h"
#include "harness/plans/device_groups.h"
#include "base/statistics.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "harness/record/table/throughput.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>
#include <set>

namespace tandem {

namespace {

double per_frame_ms(const Measurement& m, double ns) {
    return ns * 1e-6 / static_cast<double>(std::max<std::size_t>(1, m.candidate_pairs.size()));
}

/// The median over the instrumented replays, in milliseconds per frame.
template<class ValueOf>
double replay_ms(const Measurement& m, const ValueOf& value_of) {
    std::vector<std::int64_t> values;
    for (const auto& replay : m.breakdowns) values.push_back(value_of(replay));
    return values.empty() ? 0 : per_frame_ms(m, summarise(values).median);
}

double stage_ms(const Measurement& m, Stage stage, std::int64_t StageSample::*member) {
    return replay_ms(m, [&](const auto& r) { return r.totals()[static_cast<std::size_t>(stage)].*member; });
}

/// Counts are equal in all replays, so that the last one is enough.
std::uint64_t count_over(const Measurement& m, std::span<const Stage> stages,
                         std::uint64_t StageSample::*member) {
    if (m.breakdowns.empty()) return 0;
    std::uint64_t sum = 0;
    for (const auto stage : stages)
        sum += m.breakdowns.back().totals()[static_cast<std::size_t>(stage)].*member;
    return sum;
}

bool on_one_group(std::span<const Row> rows) {
    return std::ranges::all_of(
        rows, [&](const Row& row) { return row.cell->devices == rows.front().cell->devices; });
}

/// The settings that some row's name has and that are equal in all rows; none for a single row.
SettingTexts common_settings(std::span<const Row> rows) {
    SettingTexts common;
    if (rows.size() < 2) return common;
    for (const auto& row : rows)
        for (const auto& change : changes(*row.cell)) {
            const auto is_equal = [&](const Row& other) {
                const auto texts = other.cell->settings.texts();
                const auto found = texts.find(change.first);
                return found != texts.end() && *found == change;
            };
            if (std::ranges::all_of(rows, is_equal)) common.insert(change);
        }
    return common;
}

std::vector<Stage> all_stages() {
    std::vector<Stage> stages;
    for (std::size_t i = 0; i < stage_names.size(); ++i) stages.push_back(static_cast<Stage>(i));
    return stages;
}

std::uint64_t launches_of(const Measurement& m) {
    return count_over(m, all_stages(), &StageSample::launches);
}

/// By the host's clock for stages that the host does, by the device's otherwise.
double stage_ms(const Measurement& m, Stage stage) {
    const bool host =
        stage == Stage::preprocess || stage == Stage::postprocess || stage == Stage::exchange
        || (stage == Stage::broad && count_over(m, std::array{Stage::broad}, &StageSample::launches) == 0);
    return stage_ms(m, stage, host ? &StageSample::host_ns : &StageSample::device_ns);
}

/// Stages that belong together.
struct Part {
    const char* name;
    std::vector<Stage> stages;
};

const std::vector<Part>& parts() {
    static const std::vector<Part> all{{"refit", {Stage::transform, Stage::refit}},
                                       {"broad", {Stage::broad}},
                                       {"walk", {Stage::seed, Stage::traverse, Stage::balance}},
                                       {"contacts", {Stage::contact, Stage::sort, Stage::reduce}},
                                       {"transfers", {Stage::read, Stage::write, Stage::exchange}},
                                       {"conversion", {Stage::preprocess, Stage::postprocess}}};
    return all;
}

double part_ms(const Measurement& m, const Part& part) {
    double sum = 0;
    for (const auto stage : part.stages) sum += stage_ms(m, stage);
    return sum;
}

std::uint64_t total_count(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

template<class Text>
TableColumn column(std::string head, std::span<const Row> rows, const Text& text) {
    TableColumn result{std::move(head), {}};
    for (const auto& row : rows) result.texts.push_back(text(row));
    return result;
}

/// A column of counts; omitted when all are 0.
template<class Count>
TableColumn count_column(const std::string& head, std::span<const Row> rows, const Count& count) {
    std::vector<std::optional<double>> counts;
    for (const auto& row : rows) counts.emplace_back(static_cast<double>(count(row)));
    return amounts_column(head, counts);
}

/// A column of milliseconds.
template<class Ms>
TableColumn ms_column(std::string head, std::span<const Row> rows, const Ms& ms) {
    std::vector<double> values;
    for (const auto& row : rows) values.push_back(ms(*row.measurement));
    return {std::move(head), millisecond_texts(values)};
}

/// The upper median over the samples; empty for one device.
std::string imbalance_text(const Measurement& m) {
    std::vector<double> values;
    for (const auto& sample : m.samples)
        if (const auto value = sample.imbalance()) values.push_back(*value);
    if (values.empty()) return {};
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return fmt::format("{:.2f}", values[values.size() / 2]);
}

/// Half the widths of the 95 % intervals, of at least two rounds.
TableColumn interval_column(std::span<const Row> rows) {
    auto column = ms_column("95 %", rows, [](const Measurement& m) {
        if (m.round_count() < 2) return 0.0;
        const auto s = summarise(m.totals(), m.rounds());
        return per_frame_ms(m, (s.high - s.low) / 2);
    });
    for (std::size_t i = 0; i < rows.size(); ++i)
        column.texts[i] = rows[i].measurement->round_count() < 2 ? "" : "± " + column.texts[i];
    return column;
}

std::string painted(const std::string& text, const char* code, bool colour) {
    return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
}

/// Rows of cells that no comparable cell is told to beat.
std::set<std::size_t> leaders_of(const std::vector<Verdict>& verdicts) {
    std::set<std::size_t> rows;
    for (const auto& verdict : verdicts)
        for (const auto& cell : verdict.cells)
            if (verdict.is_leader(cell)) rows.insert(cell.row);
    return rows;
}

TableColumn medians_column(std::span<const Row> rows, const std::vector<Verdict>& verdicts, bool colour) {
    auto column =
        ms_column("frame", rows, [](const Measurement& m) { return per_frame_ms(m, median_ns(m)); });
    for (const auto row : leaders_of(verdicts))
        column.texts[row] = painted(column.texts[row], "1;32", colour);
    return column;
}

/// The columns that the user asked for.
std::vector<TableColumn> throughput_columns(std::span<const Row> rows, const Scene& scene,
                                            const std::vector<std::string>& names) {
    std::vector<TableColumn> columns;
    for (const auto& name : names) {
        const bool is_pairs = name == throughput_names[0];
        std::vector<std::optional<double>> amounts;
        for (const auto& row : rows) {
            auto amount = is_pairs ? pairs_per_s(*row.measurement) : bytes_per_s(row, scene);
            if (amount && !is_pairs) *amount *= 1e-9;
            amounts.push_back(amount);
        }
        columns.push_back(amounts_column(name, amounts));
    }
    return columns;
}

/// The time of each compared cell to that of the fastest one. "≈" precedes an interval that contains 1.
TableColumn ratios_column(std::span<const Row> rows, const std::vector<Verdict>& verdicts) {
    TableColumn column{"times as long", std::vector<std::string>(rows.size())};
    for (const auto& verdict : verdicts)
        for (const auto& cell : verdict.cells) {
            auto& text = column.texts[cell.row];
            const auto& [value, low, high] = cell.ratio;
            if (&cell == &verdict.cells.front())
                text = "1";
            else if (!cell.has_interval())
                text = fmt::format("{:.3g}", value);
            else
                text = fmt::format("{}{:.3g} [{:.3g}, {:.3g}]", cell.is_told_apart() ? "" : "≈ ", value, low,
                                   high);
        }
    return column;
}

/// Columns of the parts of a frame that take at least a hundredth of it in some row.
std::vector<TableColumn> part_columns(std::span<const Row> rows) {
    std::vector<TableColumn> columns;
    for (const auto& part : parts()) {
        const auto ms = [&](const Measurement& m) { return part_ms(m, part); };
        const auto shows = [&](const Row& row) {
            const auto& m = *row.measurement;
            return ms(m) >= 0.01 * per_frame_ms(m, median_ns(m)) && ms(m) > 0;
        };
        if (std::ranges::any_of(rows, shows)) columns.push_back(ms_column(part.name, rows, ms));
    }
    return columns;
}

std::vector<TableColumn> count_columns(std::span<const Row> rows) {
    return {
        column("rounds", rows, [](const Row& row) { return fmt::to_string(row.measurement->round_count()); }),
        count_column("pairs", rows,
                     [](const Row& row) { return total_count(row.measurement->candidate_pairs); }),
        count_column("contacts", rows, [](const Row& row) { return total_count(row.measurement->contacts); }),
        count_column("launches", rows, [](const Row& row) { return launches_of(*row.measurement); })};
}

/// "1 round", "3.2 M pairs".
std::string counted(const std::string& count, std::string_view noun) {
    if (count == "1" && noun.ends_with('s')) noun.remove_suffix(1);
    return fmt::format("{} {}", count, noun);
}

/// "5 rounds, 3.2 M pairs; 21 frames on host; k=8": what all rows have in common. Moves the other columns to
/// `differing`.
std::string common_line(std::span<const Row> rows, std::vector<TableColumn> columns,
                        std::vector<TableColumn>& differing) {
    std::vector<std::string> common;
    for (auto& column : columns) {
        const auto& text = column.texts.front();
        if (std::ranges::count(column.texts, text) != std::ssize(column.texts))
            differing.push_back(std::move(column));
        else if (!text.empty())
            common.push_back(counted(text, column.head));
    }
    const auto frames = fmt::to_string(rows.front().measurement->candidate_pairs.size());
    std::vector<std::string> settings;
    for (const auto& [name, value] : common_settings(rows))
        settings.push_back(fmt::format("{}={}", name, value));
    return fmt::format("{}{}{}{}{}{}", fmt::join(common, ", "), common.empty() ? "" : "; ",
                       counted(frames, "frames"),
                       on_one_group(rows) ? " on " + name_of(rows.front().cell->devices) : "",
                       settings.empty() ? "" : "; ", fmt::join(settings, ", "));
}

std::string main_table(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Scene& scene,
                       const TableStyle& style) {
    std::vector<std::string> names;
    for (const auto& row : rows) names.push_back(label_of(row, rows));
    std::vector<TableColumn> columns{medians_column(rows, verdicts, style.colour), interval_column(rows),
                                     ratios_column(rows, verdicts)};
    for (auto& more : part_columns(rows)) columns.push_back(std::move(more));
    const auto common = common_line(rows, count_columns(rows), columns);
    columns.push_back(
        column("imbalance", rows, [](const Row& row) { return imbalance_text(*row.measurement); }));
    for (auto& more : throughput_columns(rows, scene, style.throughput)) columns.push_back(std::move(more));
    columns.push_back(column("", rows, [&](const Row& row) {
        return row.measurement->agreement.ok() ? std::string() : painted("WRONG", "1;31", style.colour);
    }));
    return fmt::format("{}\n{}", paragraph(common, 2, output_columns()),
                       in_columns(names, "ms/frame", columns, style.format));
}

/// Milliseconds a frame of one device in a stage, by the host's clock for the host's work.
double device_stage_ms(const Measurement& m, std::size_t device, Stage stage) {
    const bool is_host =
        stage == Stage::preprocess || stage == Stage::postprocess || stage == Stage::exchange;
    return replay_ms(m, [&](const InstrumentedReplay& r) {
        const auto& sample = r.by_device[device][static_cast<std::size_t>(stage)];
        return is_host ? sample.host_ns : sample.device_ns;
    });
}

std::uint64_t mean_over_frames(const Measurement& m, std::size_t device, std::uint64_t DeviceWork::*member) {
    std::uint64_t sum = 0;
    for (const auto& frame : m.shared) sum += frame[device].*member;
    return sum / std::max<std::size_t>(1, m.shared.size());
}

double device_ms(const Measurement& m, std::size_t device) {
    std::vector<std::int64_t> samples;
    for (const auto& sample : m.samples) samples.push_back(sample.shared_ns[device]);
    return per_frame_ms(m, summarise(samples).median);
}

/// A column of one number a device.
template<class Value>
std::vector<double> by_device(const Measurement& m, const Value& value) {
    std::vector<double> values;
    for (std::size_t i = 0; i < m.shared.front().size(); ++i) values.push_back(static_cast<double>(value(i)));
    return values;
}

TableColumn device_counts(const std::string& head, const Measurement& m, std::uint64_t DeviceWork::*member) {
    const auto counts = by_device(m, [&](std::size_t device) { return mean_over_frames(m, device, member); });
    return amounts_column(head, {counts.begin(), counts.end()});
}

/// One row for each of several devices of a cell; empty for one device.
std::string devices_table(const Row& row, TableFormat format) {
    const auto& m = *row.measurement;
    if (m.shared.empty() || m.samples.empty() || m.breakdowns.empty()) return {};
    const auto infos = infos_of(*row.cell);
    std::vector<std::string> devices;
    for (std::size_t i = 0; i < m.shared.front().size(); ++i)
        devices.push_back(row.cell->team != nullptr ? fmt::format("rank {}, {}", i, infos[i].id)
                                                    : infos[i].id);
    std::vector<TableColumn> columns{
        device_counts("bodies", m, &DeviceWork::bodies),
        device_counts("body pairs", m, &DeviceWork::body_pairs),
        device_counts("pairs", m, &DeviceWork::pairs),
        {"ms/frame", millisecond_texts(by_device(m, [&](std::size_t i) { return device_ms(m, i); }))}};
    for (const auto stage : all_stages()) {
        const auto ms = by_device(m, [&](std::size_t i) { return device_stage_ms(m, i, stage); });
        if (std::ranges::all_of(ms, [](double value) { return value < 5e-6; })) continue;
        columns.push_back({std::string(stage_names[static_cast<std::size_t>(stage)]), millisecond_texts(ms)});
    }
    const bool is_markdown = format == TableFormat::markdown;
    return fmt::format("{}{}{}\n", paragraph("devices of " + describe(*row.cell), 2, output_columns()),
                       is_markdown ? "\n" : "", in_columns(devices, "a frame", columns, format));
}

} // namespace

std::string label_of(const Row& row, std::span<const Row> rows) {
    const auto method = method_of(*row.cell, common_settings(rows));
    return on_one_group(rows) ? method : fmt::format("{} on {}", method, name_of(row.cell->devices));
}

std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Scene& scene,
                          const TableStyle& style) {
    if (rows.empty()) return {};
    auto text = main_table(rows, verdicts, scene, style);
    for (const auto& row : rows)
        if (const auto devices = devices_table(row, style.format); !devices.empty()) text += "\n" + devices;
    return text;
}

} // namespace tandem
