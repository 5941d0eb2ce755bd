// SPDX-License-Identifier: MIT
#include "base/durable.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace tandem {

namespace {

/// The folder that has the file's name: of a link, that of the file it leads to.
std::filesystem::path folder_of(const std::string& path) {
    std::error_code none;
    const auto whole = std::filesystem::canonical(path, none);
    const auto parent = (none ? std::filesystem::path(path) : whole).parent_path();
    return parent.empty() ? "." : parent;
}

/// Some file systems sync no folder; they keep their names in order.
bool is_refused(int error) { return error == EINVAL || error == EROFS || error == ENOTSUP; }

void sync(const std::string& folder, int (*how)(int)) {
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return; // a folder that may be written to need not be one to read
    int error = 0;
    while (how(descriptor) != 0 && (error = errno) == EINTR) error = 0;
    close(descriptor);
    if (error != 0 && !is_refused(error))
        throw OutputError(fmt::format("{}: cannot be synced ({})", folder, std::strerror(error)));
}

} // namespace

void sync_folder_of(const std::string& path) { sync(folder_of(path).string(), fsync); }

} // namespace tandem
