// SPDX-License-Identifier: MIT
#include "harness/compare/labels.h"
#include "harness/compare/report.h"

#include <fmt/format.h>

namespace tandem::compare {

namespace {

/// Four digits, at most so many decimals: nanoseconds as milliseconds.
std::string milliseconds(double ns) {
    const double ms = ns * 1e-6;
    const int decimals = ms < 1 ? 4 : ms < 10 ? 3 : ms < 100 ? 2 : ms < 1000 ? 1 : 0;
    return fmt::format("{:.{}f}", ms, decimals);
}

std::string interval(const Ratio& ratio) {
    return fmt::format("{:.3f} [{:.3f}, {:.3f}]", ratio.value, ratio.low, ratio.high);
}

std::string probability(double p) { return p < 0.0001 ? "<0.0001" : fmt::format("{:.4f}", p); }

TableRow row_of(const ComparedCell& cell, const std::string& label) {
    TableRow row{one_line(label, 1000), "-", "-", "-", "-", std::string(words_of(cell.verdict)), "-"};
    if (cell.verdict == Verdict::another_answer) return row;
    row[1] = milliseconds(cell.before_ns);
    row[2] = milliseconds(cell.after_ns);
    row[3] = interval(cell.ratio);
    if (cell.p) row[4] = probability(*cell.p);
    if (cell.least_effect) row[6] = fmt::format("{:.1f} %", 100 * *cell.least_effect);
    return row;
}

Labels labels_of(const Report& report) {
    std::vector<const RecordedCell*> cells;
    for (const auto& cell : report.comparison.cells) cells.push_back(cell.before);
    return label(cells);
}

} // namespace

std::string_view words_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::slower:
        return "slower";
    case Verdict::faster:
        return "faster";
    case Verdict::within_threshold:
        return "within the threshold";
    case Verdict::not_shown:
        return "≈";
    case Verdict::too_few:
        return "too few samples to tell";
    case Verdict::another_answer:
        break;
    }
    return "another answer";
}

std::string common_names(const Report& report) { return one_line(labels_of(report).common, 1000); }

std::vector<TableRow> table_rows(const Report& report) {
    std::vector<TableRow> rows{
        {"cell", "old ms", "new ms", "new/old [95 %]", "p (Holm)", "verdict", "would show"}};
    const auto labels = labels_of(report);
    for (std::size_t i = 0; i < labels.of.size(); ++i)
        rows.push_back(row_of(report.comparison.cells[i], labels.of[i]));
    return rows;
}

} // namespace tandem::compare
