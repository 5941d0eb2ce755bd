// SPDX-License-Identifier: MIT
#include "harness/compare/cells.h"
#include "harness/compare/each_line.h"
#include "scenes/error.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem::compare {

namespace {

/// Path and commit of what a user gave.
std::pair<std::string, std::string> split_commit(const std::string& file, const std::string& commit) {
    std::error_code ignored;
    const auto at = file.rfind('@');
    if (at == std::string::npos || std::filesystem::exists(file, ignored)) return {file, commit};
    if (at + 1 == file.size())
        throw InputError(fmt::format("{}: no such file, and no commit behind the @; give FILE@COMMIT", file));
    if (!commit.empty())
        throw InputError(
            fmt::format("{}: commit {} is asked for as well; name one commit, behind the @ or by its option",
                        file, commit));
    return {file.substr(0, at), file.substr(at + 1)};
}

std::vector<std::string> commits_of(const std::vector<RecordedCell>& records) {
    std::vector<std::string> commits;
    for (const auto& record : records)
        if (std::ranges::find(commits, record.commit) == commits.end()) commits.push_back(record.commit);
    return commits;
}

/// The one commit of the records that begins so.
std::string whole_commit(const std::string& path, const std::string& start,
                         const std::vector<RecordedCell>& records) {
    const auto all = commits_of(records);
    std::vector<std::string> found;
    std::ranges::copy_if(all, std::back_inserter(found), [&](auto& c) { return c.starts_with(start); });
    if (found.size() == 1) return found.front();
    if (found.empty())
        throw InputError(
            fmt::format("{}: no record of commit {}; there are {}", path, start, fmt::join(all, ", ")));
    throw InputError(
        fmt::format("{}: commit {} may be {}; give more of it", path, start, fmt::join(found, " or ")));
}

/// Where the record of a key stands among the cells, and how many there were.
struct Place {
    std::size_t index = 0, times = 0;
};

/// Puts a record where it belongs.
void sort_in(RecordedCell&& record, RecordedCells& into, std::map<std::string, Place>& places) {
    if (record.status != "ok" || record.rounds.empty()) {
        into.left_out.push_back(std::move(record));
        return;
    }
    auto& place = places[record.key];
    if (++place.times == 1) {
        place.index = into.cells.size();
        into.cells.push_back(std::move(record));
        return;
    }
    into.repeated += place.times == 2 ? 1 : 0;
    into.cells[place.index] = std::move(record);
}

} // namespace

RecordedCells read_cells(const std::string& file, const std::string& commit) {
    RecordedCells result;
    const auto [path, start] = split_commit(file, commit);
    result.path = path;
    std::vector<RecordedCell> records;
    result.torn = each_line(path, [&](const std::string& text, std::size_t line) {
        records.push_back(read_cell(text, result.path, line));
    });
    if (records.empty())
        throw InputError(fmt::format("{}: {}; name a file of records", path,
                                     result.torn ? "its only line has no end" : "is empty"));
    if (!start.empty()) {
        result.commit = whole_commit(path, start, records);
        std::erase_if(records, [&](const auto& record) { return record.commit != result.commit; });
    }
    result.records = records.size();
    std::map<std::string, Place> places;
    for (auto& record : records) sort_in(std::move(record), result, places);
    result.commits = commits_of(result.cells);
    return result;
}

} // namespace tandem::compare
