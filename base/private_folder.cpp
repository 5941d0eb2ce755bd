// SPDX-License-Identifier: MIT
#include "base/private_folder.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace fs = std::filesystem;

std::error_code make_own(const fs::path& folder) {
    std::error_code code;
    const bool made = fs::create_directories(folder, code);
    if (made) fs::permissions(folder, fs::perms::owner_all, code);
    return code;
}

std::string why_not_own(const fs::path& folder) {
    struct stat found {};
    if (stat(folder.c_str(), &found) != 0) return {};
    if (found.st_uid != geteuid() && found.st_uid != 0)
        return fmt::format("{} belongs to another user; name a folder of your own", folder.string());
    if ((found.st_mode & (S_IWGRP | S_IWOTH)) != 0)
        return fmt::format("others can write to {}; 'chmod go-w' it, or name another", folder.string());
    return {};
}

} // namespace tandem
