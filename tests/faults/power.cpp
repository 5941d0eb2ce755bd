// SPDX-License-Identifier: MIT
// Loaded before a program, writes down what it and its children do to the files of a folder, for power.py to
// take back what a loss of power may.
//   POWER_FOLDER  the folder
//   POWER_LOG     a file outside of it; a line for every call that succeeded, its fields parted by tabs,
//   bytes
//                 in hexadecimal:
//                 make PATH | write PATH OFFSET BYTES | size PATH BYTES | sync PATH CONTENT | sync-folder
//                 PATH | rename FROM TO | remove PATH | make-folder PATH
// What stdio writes by itself is seen when it is synced: a line "sync" has all that the file holds. A file
// system that is synced is a line for everything in the folder.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <filesystem>
#include <mutex>
#include <string>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

namespace {

template<class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

std::mutex one_at_a_time;

std::string folder() {
    const char* name = std::getenv("POWER_FOLDER");
    return name == nullptr ? "" : name;
}

int log_file() {
    static const int file = [] {
        const char* path = std::getenv("POWER_LOG");
        return path == nullptr ? -1
                               : static_cast<int>(syscall(SYS_openat, AT_FDCWD, path,
                                                          O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
    }();
    return file;
}

/// Where in the folder a path leads that need not be there any more; empty: elsewhere.
std::string inside(const std::string& path) {
    const auto slash = path.rfind('/');
    const auto parent = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
    char* real = realpath(parent.c_str(), nullptr);
    if (real == nullptr) return "";
    const auto whole = std::string(real) + "/" + path.substr(slash == std::string::npos ? 0 : slash + 1);
    std::free(real);
    const auto root = folder();
    if (root.empty() || !(whole + "/").starts_with(root + "/")) return "";
    return whole == root ? "." : whole.substr(root.size() + 1);
}

std::string path_of(int file) {
    char path[4096];
    const auto length = readlink(("/proc/self/fd/" + std::to_string(file)).c_str(), path, sizeof path);
    return length <= 0 || path[0] != '/' ? "" : inside(std::string(path, static_cast<std::size_t>(length)));
}

std::string hexadecimal(const char* data, std::size_t bytes) {
    constexpr char digits[] = "0123456789abcdef";
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i) {
        const auto byte = static_cast<unsigned char>(data[i]);
        text += {digits[byte >> 4], digits[byte & 15]};
    }
    return text;
}

std::string content(const std::string& path) {
    std::string text, part(1 << 16, '\0');
    const int reader = static_cast<int>(syscall(SYS_openat, AT_FDCWD, path.c_str(), O_RDONLY | O_CLOEXEC));
    for (ssize_t got = 0; reader >= 0 && (got = syscall(SYS_read, reader, part.data(), part.size())) > 0;)
        text.append(part, 0, static_cast<std::size_t>(got));
    if (reader >= 0) syscall(SYS_close, reader);
    return hexadecimal(text.data(), text.size());
}

void print_message(const std::string& what, const std::string& path, const std::string& more = "") {
    if (path.empty() || log_file() < 0) return;
    const auto line = what + "\t" + path + (more.empty() ? "" : "\t" + more) + "\n";
    syscall(SYS_write, log_file(), line.data(), line.size());
}

/// Where a descriptor's next write goes.
off_t slot_owner(int file) {
    const int flags = fcntl(file, F_GETFL);
    return lseek(file, 0, flags >= 0 && (flags & O_APPEND) != 0 ? SEEK_END : SEEK_CUR);
}

void tell_write(int file, off_t at, const char* data, ssize_t bytes) {
    if (bytes > 0)
        print_message("write", path_of(file),
                      std::to_string(at) + "\t" + hexadecimal(data, static_cast<std::size_t>(bytes)));
}

void tell_opened(int file, bool made, bool masked) {
    if (file < 0) return;
    if (made) print_message("make", path_of(file));
    if (masked && !made) print_message("size", path_of(file), "0");
}

void tell_synced(int file) {
    struct stat facts {};
    if (fstat(file, &facts) != 0) return;
    if (S_ISDIR(facts.st_mode)) print_message("sync-folder", path_of(file));
    // A descriptor may be for writing only.
    if (S_ISREG(facts.st_mode))
        print_message("sync", path_of(file), content("/proc/self/fd/" + std::to_string(file)));
}

void tell_all() {
    print_message("sync-folder", ".");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
        const auto path = entry.path().string();
        if (entry.is_directory()) print_message("sync-folder", inside(path));
        if (entry.is_regular_file()) print_message("sync", inside(path), content(path));
    }
}

bool is_there(const char* path) { return access(path, F_OK) == 0; }

} // namespace

extern "C" {

#define TANDEM_OPEN(name)                                                                                    \
    int name(const char* path, int flags, ...) {                                                             \
        va_list more;                                                                                        \
        va_start(more, flags);                                                                               \
        const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : mode_t{0};           \
        va_end(more);                                                                                        \
        static auto* const real = next<int(const char*, int, ...)>(#name);                                   \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const bool there = is_there(path);                                                                   \
        const int file = real(path, flags, mode);                                                            \
        tell_opened(file, !there && (flags & O_CREAT) != 0, (flags & O_TRUNC) != 0);                         \
        return file;                                                                                         \
    }
TANDEM_OPEN(open)
TANDEM_OPEN(open64)
#undef TANDEM_OPEN

#define TANDEM_FOPEN(name)                                                                                   \
    FILE* name(const char* path, const char* mode) {                                                         \
        static auto* const real = next<FILE*(const char*, const char*)>(#name);                              \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const bool there = is_there(path);                                                                   \
        FILE* const file = real(path, mode);                                                                 \
        if (file != nullptr && mode[0] != 'r') tell_opened(fileno(file), !there, mode[0] == 'w');            \
        return file;                                                                                         \
    }
TANDEM_FOPEN(fopen)
TANDEM_FOPEN(fopen64)
#undef TANDEM_FOPEN

ssize_t write(int file, const void* data, std::size_t bytes) {
    static auto* const real = next<ssize_t(int, const void*, std::size_t)>("write");
    const std::lock_guard lock(one_at_a_time);
    const auto at = slot_owner(file);
    const auto done = real(file, data, bytes);
    tell_write(file, at, static_cast<const char*>(data), done);
    return done;
}

#define TANDEM_PWRITE(name)                                                                                  \
    ssize_t name(int file, const void* data, std::size_t bytes, off_t at) {                                  \
        static auto* const real = next<ssize_t(int, const void*, std::size_t, off_t)>(#name);                \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const auto done = real(file, data, bytes, at);                                                       \
        tell_write(file, at, static_cast<const char*>(data), done);                                          \
        return done;                                                                                         \
    }
TANDEM_PWRITE(pwrite)
TANDEM_PWRITE(pwrite64)
#undef TANDEM_PWRITE

ssize_t writev(int file, const struct iovec* parts, int count) {
    static auto* const real = next<ssize_t(int, const struct iovec*, int)>("writev");
    const std::lock_guard lock(one_at_a_time);
    const auto at = slot_owner(file);
    const auto done = real(file, parts, count);
    std::string all;
    for (int i = 0; i < count; ++i) all.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
    tell_write(file, at, all.data(), done);
    return done;
}

#define TANDEM_TRUNCATE(name)                                                                                \
    int name(int file, off_t bytes) {                                                                        \
        static auto* const real = next<int(int, off_t)>(#name);                                              \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const int done = real(file, bytes);                                                                  \
        if (done == 0) print_message("size", path_of(file), std::to_string(bytes));                          \
        return done;                                                                                         \
    }
TANDEM_TRUNCATE(ftruncate)
TANDEM_TRUNCATE(ftruncate64)
#undef TANDEM_TRUNCATE

#define TANDEM_SYNC(name)                                                                                    \
    int name(int file) {                                                                                     \
        static auto* const real = next<int(int)>(#name);                                                     \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const int done = real(file);                                                                         \
        if (done == 0) tell_synced(file);                                                                    \
        return done;                                                                                         \
    }
TANDEM_SYNC(fsync)
TANDEM_SYNC(fdatasync)
#undef TANDEM_SYNC

int syncfs(int file) {
    static auto* const real = next<int(int)>("syncfs");
    const std::lock_guard lock(one_at_a_time);
    const int done = real(file);
    if (done == 0) tell_all();
    return done;
}

int rename(const char* from, const char* to) noexcept {
    static auto* const real = next<int(const char*, const char*)>("rename");
    const std::lock_guard lock(one_at_a_time);
    const auto before = inside(from);
    const int done = real(from, to);
    if (done == 0) print_message("rename", before, inside(to));
    return done;
}

#define TANDEM_REMOVE(name)                                                                                  \
    int name(const char* path) noexcept {                                                                    \
        static auto* const real = next<int(const char*)>(#name);                                             \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const int done = real(path);                                                                         \
        if (done == 0) print_message("remove", inside(path));                                                \
        return done;                                                                                         \
    }
TANDEM_REMOVE(remove)
TANDEM_REMOVE(unlink)
#undef TANDEM_REMOVE

int mkdir(const char* path, mode_t mode) noexcept {
    static auto* const real = next<int(const char*, mode_t)>("mkdir");
    const std::lock_guard lock(one_at_a_time);
    const int done = real(path, mode);
    if (done == 0) print_message("make-folder", inside(path));
    return done;
}

} // extern "C"
