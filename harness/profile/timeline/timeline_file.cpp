// SPDX-License-Identifier: MIT
#include "harness/profile/timeline/timeline.h"
#include "base/error.h"

#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

const std::string& checked(const std::string& path) {
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
        throw InputError(fmt::format("{}: is no regular file; choose another file for the timeline", path));
    return path;
}

} // namespace

TimelineFile::TimelineFile(const std::string& path) : file_(checked(path)) {}

void TimelineFile::write(const nlohmann::ordered_json& timeline) {
    file_.write(timeline.dump() + "\n");
    file_.finish();
}

} // namespace tandem
