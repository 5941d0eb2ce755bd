// SPDX-License-Identifier: MIT
// Loaded before a program. It logs the file operations of the program and its children in a folder, so that
// power.py can undo those that a loss of power may undo.
//   POWER_FOLDER  the folder
//   POWER_LOG     a file outside of it, with a line per successful call; fields are separated by tabs,
//                 bytes are hexadecimal:
//                 make PATH | write PATH OFFSET BYTES | size PATH BYTES | sync PATH CONTENT |
//                 sync-folder PATH | rename FROM TO | remove PATH | make-folder PATH
// Internal writes of stdio are logged at the next sync: a line "sync" has the whole content of the file. A
// sync of the file system logs a line for every file of the folder.
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

/// Path relative to the folder; the file itself may no longer exist. Empty: outside the folder.
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

void log_operation(const std::string& operation, const std::string& path, const std::string& more = "") {
    if (path.empty() || log_file() < 0) return;
    const auto line = operation + "\t" + path + (more.empty() ? "" : "\t" + more) + "\n";
    syscall(SYS_write, log_file(), line.data(), line.size());
}

/// File offset of the descriptor's next write.
off_t write_offset(int file) {
    const int flags = fcntl(file, F_GETFL);
    return lseek(file, 0, flags >= 0 && (flags & O_APPEND) != 0 ? SEEK_END : SEEK_CUR);
}

void log_write(int file, off_t at, const char* data, ssize_t bytes) {
    if (bytes > 0)
        log_operation("write", path_of(file),
                      std::to_string(at) + "\t" + hexadecimal(data, static_cast<std::size_t>(bytes)));
}

void log_open(int file, bool made, bool masked) {
    if (file < 0) return;
    if (made) log_operation("make", path_of(file));
    if (masked && !made) log_operation("size", path_of(file), "0");
}

void log_sync(int file) {
    struct stat facts {};
    if (fstat(file, &facts) != 0) return;
    if (S_ISDIR(facts.st_mode)) log_operation("sync-folder", path_of(file));
    // The descriptor may be write-only.
    if (S_ISREG(facts.st_mode))
        log_operation("sync", path_of(file), content("/proc/self/fd/" + std::to_string(file)));
}

void log_all() {
    log_operation("sync-folder", ".");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder())) {
        const auto path = entry.path().string();
        if (entry.is_directory()) log_operation("sync-folder", inside(path));
        if (entry.is_regular_file()) log_operation("sync", inside(path), content(path));
    }
}

bool exists(const char* path) { return access(path, F_OK) == 0; }

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
        const bool existed = exists(path);                                                                   \
        const int file = real(path, flags, mode);                                                            \
        log_open(file, !existed && (flags & O_CREAT) != 0, (flags & O_TRUNC) != 0);                          \
        return file;                                                                                         \
    }
TANDEM_OPEN(open)
TANDEM_OPEN(open64)
#undef TANDEM_OPEN

#define TANDEM_FOPEN(name)                                                                                   \
    FILE* name(const char* path, const char* mode) {                                                         \
        static auto* const real = next<FILE*(const char*, const char*)>(#name);                              \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const bool existed = exists(path);                                                                   \
        FILE* const file = real(path, mode);                                                                 \
        if (file != nullptr && mode[0] != 'r') log_open(fileno(file), !existed, mode[0] == 'w');             \
        return file;                                                                                         \
    }
TANDEM_FOPEN(fopen)
TANDEM_FOPEN(fopen64)
#undef TANDEM_FOPEN

ssize_t write(int file, const void* data, std::size_t bytes) {
    static auto* const real = next<ssize_t(int, const void*, std::size_t)>("write");
    const std::lock_guard lock(one_at_a_time);
    const auto at = write_offset(file);
    const auto done = real(file, data, bytes);
    log_write(file, at, static_cast<const char*>(data), done);
    return done;
}

#define TANDEM_PWRITE(name)                                                                                  \
    ssize_t name(int file, const void* data, std::size_t bytes, off_t at) {                                  \
        static auto* const real = next<ssize_t(int, const void*, std::size_t, off_t)>(#name);                \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const auto done = real(file, data, bytes, at);                                                       \
        log_write(file, at, static_cast<const char*>(data), done);                                           \
        return done;                                                                                         \
    }
TANDEM_PWRITE(pwrite)
TANDEM_PWRITE(pwrite64)
#undef TANDEM_PWRITE

ssize_t writev(int file, const struct iovec* parts, int count) {
    static auto* const real = next<ssize_t(int, const struct iovec*, int)>("writev");
    const std::lock_guard lock(one_at_a_time);
    const auto at = write_offset(file);
    const auto done = real(file, parts, count);
    std::string all;
    for (int i = 0; i < count; ++i) all.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
    log_write(file, at, all.data(), done);
    return done;
}

#define TANDEM_TRUNCATE(name)                                                                                \
    int name(int file, off_t bytes) {                                                                        \
        static auto* const real = next<int(int, off_t)>(#name);                                              \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const int done = real(file, bytes);                                                                  \
        if (done == 0) log_operation("size", path_of(file), std::to_string(bytes));                          \
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
        if (done == 0) log_sync(file);                                                                       \
        return done;                                                                                         \
    }
TANDEM_SYNC(fsync)
TANDEM_SYNC(fdatasync)
#undef TANDEM_SYNC

int syncfs(int file) {
    static auto* const real = next<int(int)>("syncfs");
    const std::lock_guard lock(one_at_a_time);
    const int done = real(file);
    if (done == 0) log_all();
    return done;
}

int rename(const char* from, const char* to) noexcept {
    static auto* const real = next<int(const char*, const char*)>("rename");
    const std::lock_guard lock(one_at_a_time);
    const auto before = inside(from);
    const int done = real(from, to);
    if (done == 0) log_operation("rename", before, inside(to));
    return done;
}

#define TANDEM_REMOVE(name)                                                                                  \
    int name(const char* path) noexcept {                                                                    \
        static auto* const real = next<int(const char*)>(#name);                                             \
        const std::lock_guard lock(one_at_a_time);                                                           \
        const int done = real(path);                                                                         \
        if (done == 0) log_operation("remove", inside(path));                                                \
        return done;                                                                                         \
    }
TANDEM_REMOVE(remove)
TANDEM_REMOVE(unlink)
#undef TANDEM_REMOVE

int mkdir(const char* path, mode_t mode) noexcept {
    static auto* const real = next<int(const char*, mode_t)>("mkdir");
    const std::lock_guard lock(one_at_a_time);
    const int done = real(path, mode);
    if (done == 0) log_operation("make-folder", inside(path));
    return done;
}

} // extern "C"
