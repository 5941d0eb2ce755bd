// SPDX-License-Identifier: MIT
#include "harness/record/table/table.h"

#include "harness/sampling/ranks/rank_team.h"
#include "harness/sampling/statistics.h"
#include "base/text_lines.h"
#include "harness/record/table/columns.h"
#include "harness/record/table/labels.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <set>

namespace tandem {

namespace {

double per_frame_ms(const Measurement& m, double ns) {
    return ns * 1e-6 / static_cast<double>(std::max<std::size_t>(1, m.candidate_pairs.size()));
}

/// The median over the instrumented replays, in milliseconds a frame.
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

double sum_ms(const Measurement& m, std::initializer_list<Stage> stages) {
    double sum = 0;
    for (const auto stage : stages) sum += stage_ms(m, stage);
    return sum;
}

/// Kernels of the walk and its contacts, without transform, refit and broad phase.
double kernels_ms(const Measurement& m) {
    return sum_ms(m, {Stage::seed, Stage::traverse, Stage::balance, Stage::contact});
}

/// Kernels, transfers and conversions after the refit. The paper calls this the narrow phase; its wall-clock
/// overheads are not included.
double narrow_ms(const Measurement& m) {
    return kernels_ms(m) + sum_ms(m, {Stage::read, Stage::write, Stage::preprocess, Stage::postprocess});
}

std::uint64_t total_count(const std::vector<std::uint64_t>& values) {
    return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

template<class Text>
Column column(std::string head, std::span<const Row> rows, const Text& text) {
    Column result{std::move(head), {}};
    for (const auto& row : rows) result.texts.push_back(text(row));
    return result;
}

/// A column of counts; omitted when all are 0.
template<class Count>
Column count_column(std::string head, std::span<const Row> rows, const Count& count) {
    auto result = column(std::move(head), rows, [&](const Row& row) { return short_count(count(row)); });
    if (std::ranges::all_of(result.texts, [](const auto& t) { return t == "0"; }))
        result.texts.assign(rows.size(), "");
    return result;
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

std::string half_width(const Measurement& m) {
    if (m.round_count() < 2) return "±    ?";
    const auto s = summarise(m.totals(), m.rounds());
    return fmt::format("± {}", milliseconds(per_frame_ms(m, (s.high - s.low) / 2)));
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

std::string totals_table(std::span<const Row> rows, const RowLabels& labels,
                         const std::vector<Verdict>& verdicts, bool colour) {
    const auto leaders = leaders_of(verdicts);
    const auto number_of = [&](const Row& row) { return static_cast<std::size_t>(&row - rows.data()); };
    const std::vector<Column> columns{
        column("ms/frame", rows,
               [&](const Row& row) {
                   const auto text =
                       milliseconds(per_frame_ms(*row.measurement, median_ns(*row.measurement)));
                   return leaders.contains(number_of(row)) ? painted(text, "1;32", colour) : text;
               }),
        column("95 %", rows, [](const Row& row) { return half_width(*row.measurement); }),
        column("rounds", rows, [](const Row& row) { return fmt::to_string(row.measurement->round_count()); }),
        count_column("pairs", rows,
                     [](const Row& row) { return total_count(row.measurement->candidate_pairs); }),
        count_column("contacts", rows, [](const Row& row) { return total_count(row.measurement->contacts); }),
        count_column("launches", rows, [](const Row& row) { return launches_of(*row.measurement); }),
        count_column(
            "waits", rows,
            [](const Row& row) { return count_over(*row.measurement, all_stages(), &StageSample::waits); }),
        column("imbalance", rows, [](const Row& row) { return imbalance_text(*row.measurement); }),
        column("", rows, [&](const Row& row) {
            return row.measurement->agreement.ok() ? std::string() : painted("WRONG", "1;31", colour);
        })};
    return in_columns(labels.by_row, "", columns);
}

std::string stages_table(std::span<const Row> rows, const RowLabels& labels) {
    std::vector<Column> columns;
    for (const auto stage : all_stages()) {
        auto times = column(std::string(stage_names[static_cast<std::size_t>(stage)]), rows,
                            [&](const Row& row) { return milliseconds(stage_ms(*row.measurement, stage)); });
        if (std::ranges::all_of(times.texts, [](const auto& t) { return t == "0.000"; })) continue;
        columns.push_back(std::move(times));
    }
    columns.push_back(column("frame", rows, [](const Row& row) {
        return milliseconds(replay_ms(*row.measurement, [](const InstrumentedReplay& r) {
            return std::accumulate(r.frame_ns.begin(), r.frame_ns.end(), std::int64_t{0});
        }));
    }));
    return in_columns(labels.by_row, "stages, ms/frame", columns);
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

/// One row for each of several devices of a cell; empty for one device.
std::string devices_table(const Row& row, const std::string& label) {
    const auto& m = *row.measurement;
    if (m.shared.empty() || m.samples.empty() || m.breakdowns.empty()) return {};
    const auto infos = infos_of(*row.cell);
    std::vector<std::string> devices;
    std::vector<Column> columns{{"bodies", {}}, {"body pairs", {}}, {"pairs", {}}, {"ms/frame", {}}};
    for (const auto stage : all_stages())
        columns.push_back({std::string(stage_names[static_cast<std::size_t>(stage)]), {}});
    for (std::size_t i = 0; i < m.shared.front().size(); ++i) {
        devices.push_back(row.cell->team != nullptr ? fmt::format("rank {}, {}", i, infos[i].id)
                                                    : infos[i].id);
        columns[0].texts.push_back(short_count(mean_over_frames(m, i, &DeviceWork::bodies)));
        columns[1].texts.push_back(short_count(mean_over_frames(m, i, &DeviceWork::body_pairs)));
        columns[2].texts.push_back(short_count(mean_over_frames(m, i, &DeviceWork::pairs)));
        columns[3].texts.push_back(milliseconds(device_ms(m, i)));
        for (std::size_t stage = 0; stage < stage_names.size(); ++stage)
            columns[4 + stage].texts.push_back(
                milliseconds(device_stage_ms(m, i, static_cast<Stage>(stage))));
    }
    for (auto& column : columns)
        if (std::ranges::all_of(column.texts, [](const auto& t) { return t == "0.000"; }))
            column.texts.assign(devices.size(), "");
    return fmt::format("devices of {}\n{}\n", label, in_columns(devices, "a frame", columns));
}

/// With the 95 % interval for at least two rounds. "≈" precedes the ratio when the interval contains 1; "-"
/// without samples.
std::string ratio_text(const Measurement& above, const Measurement& below) {
    if (above.samples.empty() || below.samples.empty()) return "-";
    const auto cell = compared(above, below);
    if (!cell.has_interval()) return fmt::format("{:.2f}", cell.ratio.value);
    return fmt::format("{}{:.3g} [{:.3g}, {:.3g}]", cell.is_told_apart() ? "" : "≈ ", cell.ratio.value,
                       cell.ratio.low, cell.ratio.high);
}

std::string quotient(double above, double below) {
    return below > 0 ? fmt::format("{:.3g}", above / below) : std::string("-");
}

/// Ratios of the comparable rows after `base` to `base`.
std::string ratios_to(const Row& base, const std::string& base_label, std::span<const Row> rows,
                      const std::vector<std::string>& labels) {
    std::vector<Row> compared;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].cell != base.cell && comparable(base, rows[i])) {
            compared.push_back(rows[i]);
            names.push_back(labels[i]);
        }
    if (compared.empty()) return {};
    const auto& b = *base.measurement;
    const auto ratios = [&](const char* head, const auto& value) {
        return column(head, compared,
                      [&](const Row& row) { return quotient(value(*row.measurement), value(b)); });
    };
    const auto stage = [](Stage s) { return [s](const Measurement& m) { return stage_ms(m, s); }; };
    const std::vector<Column> columns{
        column("total", compared, [&](const Row& row) { return ratio_text(*row.measurement, b); }),
        ratios("narrow", narrow_ms),
        ratios("kernels", kernels_ms),
        ratios("read", stage(Stage::read)),
        ratios("write", stage(Stage::write)),
        ratios("launches", [](const Measurement& m) { return static_cast<double>(launches_of(m)); })};
    return fmt::format("times as long as {}\n{}\n", base_label, in_columns(names, "", columns));
}

/// The first row of each set of comparable rows is the base of its ratios.
std::string ratio_tables(std::span<const Row> rows, const RowLabels& labels) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool is_first =
            std::ranges::none_of(rows.first(i), [&](const Row& r) { return comparable(r, rows[i]); });
        if (is_first)
            text += ratios_to(rows[i], labels.by_row[i], rows.subspan(i),
                              {labels.by_row.begin() + static_cast<std::ptrdiff_t>(i), labels.by_row.end()});
    }
    return text;
}

} // namespace

std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, bool colour) {
    if (rows.empty()) return {};
    const auto labels = row_labels(rows);
    auto text = labels.common.empty() ? std::string() : "all: " + labels.common + "\n\n";
    text += totals_table(rows, labels, verdicts, colour) + "\n";
    text += stages_table(rows, labels) + "\n";
    for (std::size_t i = 0; i < rows.size(); ++i) text += devices_table(rows[i], labels.by_row[i]);
    text += ratio_tables(rows, labels);
    for (const auto& verdict : verdicts) text += paragraph(verdict_sentence(verdict, rows, labels.by_row), 2);
    return text;
}

} // namespace tandem
