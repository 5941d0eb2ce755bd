// SPDX-License-Identifier: MIT
#include "harness/record/unfinished.h"

#include "harness/program/environment.h"
#include "base/standard_streams.h"
#include "base/error.h"

#include <filesystem>

namespace tandem {

namespace {

/// Lines of another schema are ignored.
constexpr int unfinished_schema = 1;

bool matches_program(const nlohmann::ordered_json& line) {
    return line.value("schema", 0) == unfinished_schema && line.value("sources", "") == sources_digest();
}

} // namespace

Unfinished::Unfinished(const std::string& path, bool resume) {
    if (path.empty() || !std::filesystem::is_regular_file(path)) return;
    path_ = path + ".unfinished";
    if (!resume || !std::filesystem::exists(path_)) return;
    file_ = std::make_unique<RecordFile>(path_, Links::refused);
    file_->for_each([&](const nlohmann::ordered_json& line) {
        if (!matches_program(line)) return;
        auto& lines = lines_[line.at("key").get<std::string>()];
        if (line.contains("checked")) lines.clear();
        lines.push_back(line);
    });
}

CellState Unfinished::state(const Cell& cell, const std::string& key) {
    own_.insert(key);
    CellState state;
    const auto found = lines_.find(key);
    if (found == lines_.end() || !found->second.front().contains("checked")) return state;
    take_checked(state, found->second.front().at("checked"), cell);
    for (const auto& line : found->second) take_rounds(state, line.at("rounds"));
    return state;
}

std::vector<nlohmann::ordered_json> Unfinished::lines_of_other_cells() const {
    std::vector<nlohmann::ordered_json> lines;
    RecordFile(path_, Links::refused).for_each([&](const nlohmann::ordered_json& line) {
        if (matches_program(line) && !own_.contains(line.at("key").get<std::string>())) lines.push_back(line);
    });
    return lines;
}

void Unfinished::append(nlohmann::ordered_json line) {
    line["schema"] = unfinished_schema;
    line["sources"] = sources_digest();
    try {
        if (!file_) file_ = std::make_unique<RecordFile>(path_, Links::refused);
        file_->append(line);
    } catch (const std::runtime_error& error) {
        print_message("tandem: {}; rounds are no longer saved, but records are\n", error.what());
        path_.clear();
    }
}

void Unfinished::keep(const std::string& key, const CellState& state, bool whole) {
    if (path_.empty()) return;
    nlohmann::ordered_json line;
    if (whole) line["checked"] = checked_json(state);
    line["rounds"] = rounds_json(state, whole ? 0 : state.rounds - 1);
    line["key"] = key;
    append(std::move(line));
}

void Unfinished::remove() {
    if (path_.empty()) return;
    file_.reset();
    if (!std::filesystem::exists(path_)) return;
    try {
        const auto lines = lines_of_other_cells();
        const auto rest = path_ + ".rest";
        if (!lines.empty()) {
            std::filesystem::remove(rest);
            RecordFile file(rest, Links::refused);
            for (const auto& line : lines) file.append(line);
            std::filesystem::rename(rest, path_);
        } else {
            std::filesystem::remove(path_);
        }
    } catch (const std::exception& error) {
        print_message("tandem: {}; {} still contains rounds of recorded cells\n", error.what(), path_);
    }
}

} // namespace tandem
