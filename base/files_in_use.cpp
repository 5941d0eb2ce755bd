// SPDX-License-Identifier: MIT
#include "base/files_in_use.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <mutex>
#include <set>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace {

/// Paths, not inodes: the inode of a deleted file may become that of another one.
struct Paths {
    std::mutex mutex;
    bool is_active = false;
    std::set<std::string> inputs, outputs;
};

Paths& paths() {
    static Paths all;
    return all;
}

void note(std::set<std::string> Paths::*kind, const std::string& path) {
    const std::scoped_lock lock(paths().mutex);
    if (paths().is_active) (paths().*kind).insert(path);
}

bool names_file(const std::string& path, const struct stat& file) {
    struct stat facts {};
    return stat(path.c_str(), &facts) == 0 && facts.st_dev == file.st_dev && facts.st_ino == file.st_ino;
}

bool any_names(std::set<std::string> Paths::*kind, const struct stat& file) {
    const std::scoped_lock lock(paths().mutex);
    for (const auto& path : paths().*kind)
        if (names_file(path, file)) return true;
    return false;
}

/// Whether a file begins as a line of records does, or is compressed by xz, as older records are.
bool has_records(int descriptor) {
    // The descriptor itself may be open for writing only.
    const int file = open(fmt::format("/proc/self/fd/{}", descriptor).c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    char start[std::size_t{1} << 16];
    const auto bytes = pread(file, start, sizeof start, 0);
    close(file);
    if (bytes <= 0) return false;
    const std::string_view text(start, static_cast<std::size_t>(bytes));
    const auto line = text.substr(0, text.find('\n'));
    return text.starts_with("\xfd"
                            "7zXZ")
           || (line.starts_with('{')
               && (line.find("\"schema\":") != line.npos || line.find("\"schema\" :") != line.npos));
}

[[noreturn]] void refuse(const std::string& path, std::string_view what) {
    throw InputError(fmt::format("{}: {}; choose another file for the output", path, what));
}

[[noreturn]] void refuse_unwritable(const std::string& path, int error) {
    throw InputError(
        fmt::format("{}: cannot be written ({}); choose another file", path, std::strerror(error)));
}

/// Refuses a file that does not exist yet where it cannot be made.
void check_place(const std::string& path) {
    struct stat facts {};
    const auto parent = std::filesystem::path(path).parent_path();
    const auto folder = parent.empty() ? std::string(".") : parent.string();
    if (stat(folder.c_str(), &facts) != 0 || access(folder.c_str(), W_OK | X_OK) != 0)
        refuse_unwritable(path, errno);
}

} // namespace

FilesInUse::FilesInUse() { paths().is_active = true; }

FilesInUse::~FilesInUse() {
    const std::scoped_lock lock(paths().mutex);
    paths().is_active = false;
    paths().inputs.clear();
    paths().outputs.clear();
}

void note_input(const std::string& path) {
    struct stat facts {};
    if (stat(path.c_str(), &facts) == 0 && S_ISREG(facts.st_mode) && any_names(&Paths::outputs, facts))
        refuse(path, "is an input and an output of this command");
    note(&Paths::inputs, path);
}

void note_output(const std::string& path) { note(&Paths::outputs, path); }

void refuse_appending(int descriptor, const std::string& path) {
    struct stat facts {};
    if (fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) return;
    if (any_names(&Paths::inputs, facts)) refuse(path, "is an input of this command");
}

void refuse_overwriting(int descriptor, const std::string& path) {
    struct stat facts {};
    if (fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) return;
    if (any_names(&Paths::inputs, facts)) refuse(path, "is an input of this command");
    if (any_names(&Paths::outputs, facts)) refuse(path, "is another output of this command");
    if (has_records(descriptor)) refuse(path, "is a file of records, which are never overwritten");
}

void check_name(const std::string& path) {
    struct stat facts {};
    if (stat(path.c_str(), &facts) != 0 && errno != ENOENT) refuse_unwritable(path, errno);
}

void check_output(const std::string& path) {
    check_name(path);
    struct stat facts {};
    if (stat(path.c_str(), &facts) != 0) return check_place(path);
    if (!S_ISREG(facts.st_mode)) return; // the writer decides on pipes, terminals and folders
    const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor < 0) refuse_unwritable(path, errno);
    try {
        refuse_overwriting(descriptor, path);
    } catch (...) {
        close(descriptor);
        throw;
    }
    close(descriptor);
}

} // namespace tandem
