// SPDX-License-Identifier: MIT
#include "harness/report/against.h"

#include "harness/compare/labels.h"
#include "harness/compare/report.h"
#include "harness/report/interned.h"

#include <algorithm>
#include <filesystem>
#include <vector>

namespace tandem::report {

namespace {

/// Of more cells the first are shown, and the page says of how many.
constexpr std::size_t most_differences = 3000;

Json row_of(const compare::ComparedCell& cell, const std::string& label) {
    Json row{{"label", label}, {"verdict", compare::words_of(cell.verdict)}};
    if (cell.verdict == compare::Verdict::another_answer) return row;
    row["old"] = rounded(cell.before_ns / 1e6);
    row["new"] = rounded(cell.after_ns / 1e6);
    row["ratio"] = {rounded(cell.ratio.value), rounded(cell.ratio.low), rounded(cell.ratio.high)};
    row["p"] = cell.p ? Json(rounded(*cell.p)) : Json();
    row["would_show"] = cell.least_effect ? Json(rounded(*cell.least_effect)) : Json();
    return row;
}

} // namespace

std::string differences(const std::string& before, const std::string& after) {
    const auto old_cells = compare::read_cells(before, "");
    const auto new_cells = compare::read_cells(after, "");
    const compare::Options options;
    const auto comparison = compare::compare(old_cells, new_cells, options);
    const compare::Report report{old_cells, new_cells, options, comparison};
    std::vector<const compare::RecordedCell*> cells;
    for (const auto& cell : comparison.cells) cells.push_back(cell.before);
    const auto labels = compare::label(cells);
    Json rows = Json::array();
    for (std::size_t i = 0; i < std::min(cells.size(), most_differences); ++i)
        rows.push_back(row_of(comparison.cells[i], labels.of[i]));
    const auto name = [](const std::string& path) { return std::filesystem::path(path).filename().string(); };
    const Json json{{"old", name(before)},
                    {"new", name(after)},
                    {"common", labels.common},
                    {"summary", compare::summary(report)},
                    {"notes", compare::notes(report)},
                    {"of", cells.size()},
                    {"cells", rows}};
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace tandem::report
