// SPDX-License-Identifier: MIT
#include "harness/record/journal.h"

#include "base/standard_streams.h"
#include "harness/record/torn_line.h"
#include "base/durable.h"
#include "base/error.h"
#include "base/files_in_use.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace {

/// Excludes other processes that append to the file. Has no effect on file systems without locks.
class AppendLock {
public:
    explicit AppendLock(int file) : file_(file) {
        while (flock(file_, LOCK_EX) != 0 && errno == EINTR) {}
    }
    ~AppendLock() { flock(file_, LOCK_UN); }
    AppendLock(const AppendLock&) = delete;
    AppendLock& operator=(const AppendLock&) = delete;

private:
    int file_;
};

/// The descriptor that a path such as /dev/fd/3 names; -1 for any other path.
int descriptor_named(std::string_view path) {
    if (path == "/dev/stdout") return STDOUT_FILENO;
    if (path == "/dev/stderr") return STDERR_FILENO;
    for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
        if (!path.starts_with(folder)) continue;
        const auto number = path.substr(folder.size());
        int descriptor = -1;
        const auto [end, error] = std::from_chars(number.begin(), number.end(), descriptor);
        if (error == std::errc{} && end == number.end()) return descriptor;
    }
    return -1;
}

/// Duplicates a descriptor instead of opening its path: both then share one file offset, so that printed text
/// does not overwrite records.
int duplicate(int descriptor) {
    const int flags = fcntl(descriptor, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) == O_RDONLY) errno = EBADF;
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) return -1;
    return fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
}

/// Regular files are also opened for reading, because repairs read the last line. A pipe is opened for
/// writing only: opened for both, it would not wait for a reader.
int open_for_appending(const std::string& path, Links links) {
    if (links == Links::followed) check_name(path + ".unfinished.rest"); // the longest name beside it
    if (links == Links::refused)
        return open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (const int descriptor = descriptor_named(path); descriptor >= 0) return duplicate(descriptor);
    struct stat facts {};
    const bool special = stat(path.c_str(), &facts) == 0 && !S_ISREG(facts.st_mode);
    return open(path.c_str(), (special ? O_WRONLY : O_RDWR | O_CREAT) | O_APPEND | O_CLOEXEC, 0644);
}

bool is_regular(int file) {
    struct stat facts {};
    return fstat(file, &facts) == 0 && S_ISREG(facts.st_mode);
}

struct Written {
    std::size_t bytes = 0;
    int error = 0; ///< errno of the failed write; 0 when everything is written
};

/// Uses one write call, unless a signal or a limit interrupts it.
Written write_all(int file, std::string_view text) {
    Written written;
    while (written.bytes < text.size()) {
        const auto n = write(file, text.data() + written.bytes, text.size() - written.bytes);
        if (n >= 0) {
            written.bytes += static_cast<std::size_t>(n);
        } else if (errno == EAGAIN) { // a full non-blocking pipe
            pollfd ready{file, POLLOUT, 0};
            poll(&ready, 1, -1);
        } else if (errno != EINTR) {
            written.error = errno;
            return written;
        }
    }
    return written;
}

/// The errno of a failed synchronisation to disk; 0 for files that cannot be synchronised, such as pipes and
/// terminals.
int sync_error(int file) {
    while (fsync(file) != 0) {
        if (errno == EINVAL || errno == EROFS || errno == ENOTSUP) return 0;
        if (errno != EINTR) return errno;
    }
    return 0;
}

} // namespace

RecordFile::RecordFile(const std::string& path, Links links)
    : RecordFile(path, path.empty() ? -1 : open_for_appending(path, links)) {
    if (path.empty() || !is_repairable_) return;
    const AppendLock lock(file_);
    try {
        refuse_appending(file_, path_);
        if (links == Links::followed) note_output(path_);
        if (size_of(file_, path_) == 0) sync_folder_of(path_); // the file may be new
        check_first_line(file_, path_);
        repair_last_line(file_, path_);
    } catch (const OutputError& error) {
        throw InputError(fmt::format("{}; choose another --out", error.what()));
    }
}

RecordFile::RecordFile(const std::string& path, int file) : path_(path), file_(file) {
    if (!path.empty() && file < 0)
        throw InputError(
            fmt::format("{}: cannot be written ({}); choose another --out", path, std::strerror(errno)));
    is_repairable_ = file >= 0 && descriptor_named(path) < 0 && is_regular(file);
}

RecordFile::~RecordFile() {
    if (file_ >= 0) close(file_);
}

void RecordFile::append(const nlohmann::ordered_json& record) {
    if (file_ < 0) return;
    failed_ = true;
    // JSON must be UTF-8, but file names in a record need not be.
    write_line(record.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    failed_ = false;
    ++appended_;
}

bool RecordFile::append_or_report(const nlohmann::ordered_json& record) {
    try {
        append(record);
    } catch (const OutputError& error) {
        print_message("tandem: {}\n", error.what());
        return false;
    }
    return true;
}

void RecordFile::write_line(const std::string& line) {
    // Where printed text and records go to the same file, text that was printed earlier comes first.
    if (descriptor_named(path_) >= 0) flush_output();
    const AppendLock lock(file_);
    // Another process may have been killed while it wrote a line.
    if (is_repairable_) repair_last_line(file_, path_);
    const auto before = is_repairable_ ? size_of(file_, path_) : 0;
    const auto [bytes, error] = write_all(file_, line);
    if (error == 0) {
        if (const int not_synced = sync_error(file_); not_synced != 0)
            throw OutputError(fmt::format("{}: writing failed ({})", path_, std::strerror(not_synced)));
        return;
    }
    // A process without the lock may have appended too; truncation must not remove its text.
    const bool alone = is_repairable_ && bytes > 0 && size_of(file_, path_) == before + bytes;
    if (alone && ftruncate(file_, static_cast<off_t>(before)) != 0)
        throw OutputError(fmt::format("{}: writing failed ({}) and left a partial line, which the next "
                                      "record moves to {}.torn",
                                      path_, std::strerror(error), path_));
    throw OutputError(
        fmt::format("{}: writing failed ({}); earlier records are complete", path_, std::strerror(error)));
}

void RecordFile::for_each(const std::function<void(const nlohmann::ordered_json&)>& visit) const {
    if (!is_repairable_) return;
    std::size_t at = 0;
    for (std::string line; read_line(file_, path_, at, line); at += line.size() + 1) {
        const auto json = nlohmann::ordered_json::parse(line, nullptr, false);
        if (json.is_object()) visit(json);
    }
}

} // namespace tandem
