// SPDX-License-Identifier: MIT
#include "harness/record/journal.h"

#include "harness/commands/standard_streams.h"
#include "harness/record/torn_line.h"
#include "base/durable.h"
#include "base/error.h"

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

/// Alone with the file among those that append. File systems without locks go without.
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

/// The descriptor that a path is another name of; -1 for any other path.
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

/// A descriptor is shared, not opened anew: what is printed to it goes behind the records, not over them.
int share(int descriptor) {
    const int flags = fcntl(descriptor, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) == O_RDONLY) errno = EBADF;
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) return -1;
    return fcntl(descriptor, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
}

/// Files are read as well, for what a kill has left; a pipe that was opened for both would wait for no
/// reader.
int open_for_appending(const std::string& path, Links links) {
    if (links == Links::refused)
        return open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW | O_CLOEXEC, 0644);
    if (const int descriptor = descriptor_named(path); descriptor >= 0) return share(descriptor);
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
    int error = 0; ///< errno of the write that ended it; 0: all is written
};

/// One write, unless a signal or a limit cuts it short.
Written write_all(int file, std::string_view text) {
    Written written;
    while (written.bytes < text.size()) {
        const auto n = write(file, text.data() + written.bytes, text.size() - written.bytes);
        if (n >= 0) {
            written.bytes += static_cast<std::size_t>(n);
        } else if (errno == EAGAIN) { // a pipe that does not wait for its reader
            pollfd ready{file, POLLOUT, 0};
            poll(&ready, 1, -1);
        } else if (errno != EINTR) {
            written.error = errno;
            return written;
        }
    }
    return written;
}

/// The errno of a write that did not reach the disk; 0 for what cannot be synchronised, as pipes and
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
    if (path.empty() || !can_be_mended_) return;
    const AppendLock lock(file_);
    try {
        if (size_of(file_, path_) == 0) sync_folder_of(path_); // it may be new
        check_first_line(file_, path_);
        mend_last_line(file_, path_);
    } catch (const OutputError& error) {
        throw InputError(fmt::format("{}; choose another --out", error.what()));
    }
}

RecordFile::RecordFile(const std::string& path, int file) : path_(path), file_(file) {
    if (!path.empty() && file < 0)
        throw InputError(
            fmt::format("{}: cannot be written ({}); choose another --out", path, std::strerror(errno)));
    can_be_mended_ = file >= 0 && descriptor_named(path) < 0 && is_regular(file);
}

RecordFile::~RecordFile() {
    if (file_ >= 0) close(file_);
}

void RecordFile::append(const nlohmann::ordered_json& record) {
    if (file_ < 0) return;
    failed_ = true;
    // File names need not be UTF-8; JSON must be.
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
    // What was printed comes before it, where both go to one place.
    if (descriptor_named(path_) >= 0) flush_output();
    const AppendLock lock(file_);
    // Another process may have been killed in the midst of its line.
    if (can_be_mended_) mend_last_line(file_, path_);
    const auto before = can_be_mended_ ? size_of(file_, path_) : 0;
    const auto [bytes, error] = write_all(file_, line);
    if (error == 0) {
        if (const int not_synced = sync_error(file_); not_synced != 0)
            throw OutputError(fmt::format("{}: writing failed ({})", path_, std::strerror(not_synced)));
        return;
    }
    // Who takes no lock may have appended as well: what is his is left.
    const bool alone = can_be_mended_ && bytes > 0 && size_of(file_, path_) == before + bytes;
    if (alone && ftruncate(file_, static_cast<off_t>(before)) != 0)
        throw OutputError(fmt::format("{}: writing failed ({}) and left a part of a line, which the next "
                                      "record moves to {}.torn",
                                      path_, std::strerror(error), path_));
    throw OutputError(
        fmt::format("{}: writing failed ({}); the records before are whole", path_, std::strerror(error)));
}

void RecordFile::for_each(const std::function<void(const nlohmann::ordered_json&)>& visit) const {
    if (!can_be_mended_) return;
    std::size_t at = 0;
    for (std::string line; read_line(file_, path_, at, line); at += line.size() + 1) {
        const auto json = nlohmann::ordered_json::parse(line, nullptr, false);
        if (json.is_object()) visit(json);
    }
}

} // namespace tandem
