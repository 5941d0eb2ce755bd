// SPDX-License-Identifier: MIT
#include "harness/profile/timeline/timeline.h"
#include "base/error.h"
#include "base/files_in_use.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tandem {

namespace {

std::string reason() { return std::strerror(errno); }

} // namespace

TimelineFile::TimelineFile(const std::string& path) : path_(path) {
    if (path.empty()) return;
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored))
        throw InputError(fmt::format("{}: is no regular file; choose another file for the timeline", path));
    temporary_ = fmt::format("{}.{}", path, getpid());
    check_output(path);
    file_ = std::fopen(temporary_.c_str(), "wx");
    if (file_ == nullptr)
        throw InputError(fmt::format("{}: cannot be written ({}); choose another file", path, reason()));
}

TimelineFile::~TimelineFile() {
    if (file_ == nullptr) return;
    std::fclose(file_);
    std::remove(temporary_.c_str());
}

void TimelineFile::write(const nlohmann::ordered_json& timeline) {
    if (file_ == nullptr) return;
    const auto text = timeline.dump() + "\n";
    bool whole = std::fwrite(text.data(), 1, text.size(), file_) == text.size() && std::fflush(file_) == 0
                 && fsync(fileno(file_)) == 0;
    whole = std::fclose(file_) == 0 && whole;
    file_ = nullptr;
    if (whole && std::rename(temporary_.c_str(), path_.c_str()) == 0) return;
    const auto failure = reason();
    std::remove(temporary_.c_str());
    throw OutputError(fmt::format("{}: writing failed ({})", path_, failure));
}

} // namespace tandem
