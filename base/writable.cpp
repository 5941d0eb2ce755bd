// SPDX-License-Identifier: MIT
#include "base/writable.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace tandem {

std::string why_not_writable(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return error.message();
    // Permissions alone do not tell: a file system can be read-only or full.
    auto name = (folder / ".tandem-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file < 0) return std::strerror(errno);
    close(file);
    unlink(name.c_str());
    return {};
}

} // namespace tandem
