// SPDX-License-Identifier: MIT
#include "harness/record/table/table.h"

#include "harness/plans/cell_session.h"
#include "base/statistics.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "harness/record/table/throughput.h"

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

/// Half the widths of the 95 % intervals; "?" for one round.
TableColumn interval_column(std::span<const Row> rows) {
    auto column = ms_column("95 %", rows, [](const Measurement& m) {
        if (m.round_count() < 2) return 0.0;
        const auto s = summarise(m.totals(), m.rounds());
        return per_frame_ms(m, (s.high - s.low) / 2);
    });
    for (std::size_t i = 0; i < rows.size(); ++i)
        column.texts[i] = "± " + (rows[i].measurement->round_count() < 2 ? "?" : column.texts[i]);
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
        ms_column("ms/frame", rows, [](const Measurement& m) { return per_frame_ms(m, median_ns(m)); });
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

std::string totals_table(std::span<const Row> rows, const std::vector<std::string>& names,
                         const std::vector<Verdict>& verdicts, const Scene& scene, const TableStyle& style) {
    std::vector<TableColumn> columns{
        medians_column(rows, verdicts, style.colour),
        interval_column(rows),
        column("rounds", rows, [](const Row& row) { return fmt::to_string(row.measurement->round_count()); }),
        count_column("pairs", rows,
                     [](const Row& row) { return total_count(row.measurement->candidate_pairs); }),
        count_column("contacts", rows, [](const Row& row) { return total_count(row.measurement->contacts); }),
        count_column("launches", rows, [](const Row& row) { return launches_of(*row.measurement); }),
        count_column(
            "waits", rows,
            [](const Row& row) { return count_over(*row.measurement, all_stages(), &StageSample::waits); }),
        column("imbalance", rows, [](const Row& row) { return imbalance_text(*row.measurement); })};
    for (auto& more : throughput_columns(rows, scene, style.throughput)) columns.push_back(std::move(more));
    columns.push_back(column("", rows, [&](const Row& row) {
        return row.measurement->agreement.ok() ? std::string() : painted("WRONG", "1;31", style.colour);
    }));
    return in_columns(names, "", columns, style.format);
}

std::string stages_table(std::span<const Row> rows, const std::vector<std::string>& names,
                         TableFormat format) {
    std::vector<TableColumn> columns;
    for (const auto stage : all_stages()) {
        const auto ms = [stage](const Measurement& m) { return stage_ms(m, stage); };
        if (std::ranges::all_of(rows, [&](const Row& row) { return ms(*row.measurement) < 5e-6; })) continue;
        columns.push_back(ms_column(std::string(stage_names[static_cast<std::size_t>(stage)]), rows, ms));
    }
    columns.push_back(ms_column("frame", rows, [](const Measurement& m) {
        return replay_ms(m, [](const InstrumentedReplay& r) {
            return std::accumulate(r.frame_ns.begin(), r.frame_ns.end(), std::int64_t{0});
        });
    }));
    return in_columns(names, "stages, ms/frame", columns, format);
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
std::string ratios_to(const Row& base, std::span<const Row> rows, TableFormat format) {
    std::vector<Row> compared;
    std::vector<std::string> names;
    for (const auto& row : rows)
        if (row.cell != base.cell && comparable(base, row)) {
            compared.push_back(row);
            names.push_back(describe(*row.cell));
        }
    if (compared.empty()) return {};
    const auto& b = *base.measurement;
    const auto ratios = [&](const char* head, const auto& value) {
        return column(head, compared,
                      [&](const Row& row) { return quotient(value(*row.measurement), value(b)); });
    };
    const auto stage = [](Stage s) { return [s](const Measurement& m) { return stage_ms(m, s); }; };
    const std::vector<TableColumn> columns{
        column("total", compared, [&](const Row& row) { return ratio_text(*row.measurement, b); }),
        ratios("narrow", narrow_ms),
        ratios("kernels", kernels_ms),
        ratios("read", stage(Stage::read)),
        ratios("write", stage(Stage::write)),
        ratios("launches", [](const Measurement& m) { return static_cast<double>(launches_of(m)); })};
    const bool is_markdown = format == TableFormat::markdown; // in which a line before a table joins it
    return fmt::format("{}{}{}\n", paragraph("times as long as " + describe(*base.cell), 2, output_columns()),
                       is_markdown ? "\n" : "", in_columns(names, "", columns, format));
}

/// The first row of each set of comparable rows is the base of its ratios.
std::string ratio_tables(std::span<const Row> rows, TableFormat format) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool is_first =
            std::ranges::none_of(rows.first(i), [&](const Row& r) { return comparable(r, rows[i]); });
        if (is_first) text += ratios_to(rows[i], rows.subspan(i), format);
    }
    return text;
}

} // namespace

std::string result_tables(std::span<const Row> rows, const std::vector<Verdict>& verdicts, const Scene& scene,
                          const TableStyle& style) {
    if (rows.empty()) return {};
    std::vector<std::string> names;
    for (const auto& row : rows) names.push_back(describe(*row.cell));
    auto text = totals_table(rows, names, verdicts, scene, style) + "\n";
    text += stages_table(rows, names, style.format) + "\n";
    for (const auto& row : rows) text += devices_table(row, style.format);
    text += ratio_tables(rows, style.format);
    for (const auto& verdict : verdicts)
        text += paragraph(verdict_sentence(verdict, rows, names), 2, output_columns());
    return text;
}

} // namespace tandem
