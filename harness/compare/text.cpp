// SPDX-License-Identifier: MIT
#include "harness/compare/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem::compare {

namespace {

/// Where records come from: "FILE: 24 cells, commit 133aed5766b2".
std::string origin(const RecordedCells& side) {
    std::vector<std::string> commits;
    for (const auto& commit : side.commits) commits.push_back(commit.empty() ? "unknown" : commit);
    bool dirty = false;
    for (const auto& cell : side.cells) dirty = dirty || cell.dirty;
    return fmt::format("{}: {} {}, {} {}{}", side.path, side.cells.size(),
                       side.cells.size() == 1 ? "cell" : "cells", commits.size() == 1 ? "commit" : "commits",
                       fmt::join(commits, ", "), dirty ? " with changes that are not committed" : "");
}

/// A bar would begin another cell of the table, and what looks like HTML or a star would be read as such.
std::string escaped(const std::string& text) {
    std::string result;
    for (const auto byte : text) {
        if (std::string_view("|<>*_`\\[]").find(byte) != std::string_view::npos) result += '\\';
        result += byte;
    }
    return result;
}

} // namespace

std::string text_of(const Report& report) {
    auto text = paragraph("old  " + one_line(origin(report.before), 1000), 5);
    text += paragraph("new  " + one_line(origin(report.after), 1000), 5);
    if (const auto common = common_names(report); !common.empty()) text += paragraph("all  " + common, 5);
    text += "\n" + table(table_rows(report)) + "\n";
    for (const auto& note : notes(report)) text += paragraph(note, 2);
    return text + paragraph(summary(report), 2);
}

std::string markdown_of(const Report& report) {
    auto text = fmt::format("**{}**\n\nold: {}  \nnew: {}  \nall: {}\n\n", escaped(summary(report)),
                            escaped(one_line(origin(report.before), 1000)),
                            escaped(one_line(origin(report.after), 1000)), escaped(common_names(report)));
    bool heading = true;
    for (const auto& row : table_rows(report)) {
        for (const auto& cell : row) text += fmt::format("| {} ", escaped(cell));
        text += heading ? "|\n|---|---:|---:|---:|---:|---|---:|\n" : "|\n";
        heading = false;
    }
    text += "\n";
    for (const auto& note : notes(report)) text += fmt::format("- {}\n", escaped(one_line(note, 2000)));
    return text;
}

} // namespace tandem::compare
