// SPDX-License-Identifier: MIT
#include "base/whole_file.h"

#include "base/error.h"
#include "base/files_in_use.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace tandem {

namespace fs = std::filesystem;

WholeFile::WholeFile(const std::string& path) : path_(path), target_(path) {
    if (path.empty()) return;
    check_output(path);
    std::error_code code;
    const bool exists = fs::exists(path, code);
    if (exists) target_ = fs::canonical(path, code).string();
    if (!exists || fs::is_regular_file(path, code)) temporary_ = fmt::format("{}.{}", target_, getpid());
    file_ = temporary_.empty() ? std::fopen(path.c_str(), "a") : std::fopen(temporary_.c_str(), "wx");
    if (file_ == nullptr)
        throw InputError(
            fmt::format("{}: cannot be written ({}); choose another file", path, std::strerror(errno)));
    note_output(path);
}

WholeFile::~WholeFile() { discard(); }

void WholeFile::discard() {
    if (file_ == nullptr) return;
    std::fclose(file_);
    file_ = nullptr;
    if (!temporary_.empty()) std::remove(temporary_.c_str());
}

void WholeFile::fail() {
    const auto error = errno;
    discard();
    throw OutputError(fmt::format("{}: writing failed ({})", path_, std::strerror(error)));
}

void WholeFile::write(std::string_view text) {
    if (file_ == nullptr) return;
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size() || std::fflush(file_) != 0) fail();
}

void WholeFile::finish() {
    if (file_ == nullptr) return;
    if (!temporary_.empty()
        && (fsync(fileno(file_)) != 0 || std::rename(temporary_.c_str(), target_.c_str()) != 0))
        fail();
    const bool closed = std::fclose(file_) == 0;
    file_ = nullptr;
    if (!closed) throw OutputError(fmt::format("{}: writing failed ({})", path_, std::strerror(errno)));
}

} // namespace tandem
