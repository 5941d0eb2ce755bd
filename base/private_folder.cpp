// SPDX-License-Identifier: MIT
#include "base/private_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace fs = std::filesystem;

std::error_code make_own(const fs::path& folder) {
    std::error_code code;
    const bool created = fs::create_directories(folder, code);
    if (created) fs::permissions(folder, fs::perms::owner_all, code);
    return code;
}

std::string why_not_writable(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return error.message();
    auto name = (folder / ".tandem-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) return std::strerror(errno);
    std::string why;
    if (write(file, "\n", 1) != 1) why = std::strerror(errno);
    if (close(file) != 0 && why.empty()) why = std::strerror(errno);
    unlink(name.c_str());
    return why;
}

std::string why_not_own(const fs::path& folder) {
    struct stat status {};
    if (stat(folder.c_str(), &status) != 0) return {};
    if (status.st_uid != geteuid() && status.st_uid != 0)
        return fmt::format("{} belongs to another user; name a folder of your own", folder.string());
    if ((status.st_mode & (S_IWGRP | S_IWOTH)) != 0)
        return fmt::format("other users can write to {}; run 'chmod go-w' on it or name another folder",
                           folder.string());
    return {};
}

} // namespace tandem
