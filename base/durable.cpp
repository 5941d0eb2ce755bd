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

/// The folder that contains the file; for a symbolic link, the folder of its target.
std::filesystem::path folder_of(const std::string& path) {
    std::error_code error;
    const auto whole = std::filesystem::canonical(path, error);
    const auto parent = (error ? std::filesystem::path(path) : whole).parent_path();
    return parent.empty() ? "." : parent;
}

/// Some file systems cannot sync a folder; they keep changes of names in order themselves.
bool is_unsupported(int error) { return error == EINVAL || error == EROFS || error == ENOTSUP; }

void sync(const std::string& folder, int (*sync_call)(int)) {
    const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return; // a writable folder need not be readable
    int error = 0;
    while (sync_call(descriptor) != 0 && (error = errno) == EINTR) error = 0;
    close(descriptor);
    if (error != 0 && !is_unsupported(error))
        throw OutputError(fmt::format("{}: cannot be synced ({})", folder, std::strerror(error)));
}

} // namespace

void sync_folder_of(const std::string& path) { sync(folder_of(path).string(), fsync); }

} // namespace tandem
