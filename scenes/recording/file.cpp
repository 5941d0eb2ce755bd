// SPDX-License-Identifier: MIT
#include "scenes/recording/file.h"

#include "base/durable.h"
#include "base/error.h"
#include "base/files_in_use.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem::recording {

namespace {

int flags_of(RecordingFile::Mode mode) {
    switch (mode) {
    case RecordingFile::Mode::read:
        return O_RDONLY | O_CLOEXEC;
    case RecordingFile::Mode::create:
        return O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC; // does not follow links
    case RecordingFile::Mode::update:
        return O_RDWR | O_CLOEXEC;
    case RecordingFile::Mode::replace:
        break;
    }
    return O_RDWR | O_CREAT | O_CLOEXEC; // truncated after the lock is taken
}

/// Users who can create files in the folder must not redirect the output by a link.
void refuse_link(const std::string& path) {
    if (std::filesystem::is_symlink(std::filesystem::symlink_status(path)))
        throw InputError(fmt::format("{}: is a link, and a file has to be made there; remove it", path));
}

/// Creates the file for new content. Removes one that a killed process left; its lock ended with the process.
RecordingFile make_partial(const std::string& path) {
    refuse_link(path);
    if (std::filesystem::exists(path)) {
        const RecordingFile lock(path,
                                 RecordingFile::Mode::update); // throws while another process has the lock
        remove_if_exists(path);
    }
    return RecordingFile(path, RecordingFile::Mode::create);
}

} // namespace

RecordingFile::RecordingFile(const std::string& path, Mode mode) : path_(path), descriptor_(-1) {
    constexpr mode_t permissions = 0666; // the umask is subtracted
    descriptor_ = open(path.c_str(), flags_of(mode), permissions);
    if (descriptor_ < 0 && errno == EEXIST)
        throw InputError(
            fmt::format("{}: exists and is not overwritten; resume it or choose another file", path));
    if (descriptor_ < 0) fail(mode == Mode::read ? "cannot be read" : "cannot be written");
    struct stat status {};
    if (fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode)
        && (mode == Mode::read || flock(descriptor_, LOCK_EX | LOCK_NB) == 0)) {
        if (mode == Mode::replace) replace_content();
        return;
    }
    close(std::exchange(descriptor_, -1));
    throw InputError(fmt::format("{}: {}", path,
                                 S_ISREG(status.st_mode) ? "another process writes it; wait for its end"
                                                         : "is not a regular file; choose another"));
}

/// Nothing has been lost when this throws: the old content is still there.
void RecordingFile::replace_content() {
    try {
        refuse_overwriting(descriptor_, path_);
        truncate(0);
    } catch (...) {
        close(std::exchange(descriptor_, -1));
        throw;
    }
}

RecordingFile::~RecordingFile() {
    if (descriptor_ >= 0) close(descriptor_);
}

void RecordingFile::fail(std::string_view what) const {
    throw InputError(fmt::format("{}: {} ({})", path_, what, std::strerror(errno)));
}

void RecordingFile::fail_writing(std::string_view what) const {
    throw OutputError(fmt::format("{}: {} ({})", path_, what, std::strerror(errno)));
}

std::uint64_t RecordingFile::size() const {
    struct stat status {};
    if (fstat(descriptor_, &status) != 0) fail("cannot be read");
    return static_cast<std::uint64_t>(status.st_size);
}

std::string RecordingFile::read(std::uint64_t offset, std::size_t bytes) const {
    std::string result(bytes, '\0');
    std::size_t got = 0;
    while (got < bytes) {
        const auto n = pread(descriptor_, result.data() + got, bytes - got, static_cast<off_t>(offset + got));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail("reading failed");
        if (n == 0) throw InputError(fmt::format("{}: became shorter while it was read", path_));
        got += static_cast<std::size_t>(n);
    }
    return result;
}

void RecordingFile::write(std::uint64_t offset, std::string_view bytes) {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const auto n =
            pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail_writing("writing failed");
        done += static_cast<std::size_t>(n);
    }
}

void RecordingFile::truncate(std::uint64_t size) {
    if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail_writing("cannot be shortened");
}

void RecordingFile::sync() {
    if (fsync(descriptor_) != 0) fail_writing("writing failed");
}

std::string read_whole(const std::string& path) {
    const RecordingFile file(path, RecordingFile::Mode::read);
    return file.read(0, file.size());
}

void replace_whole(const std::string& path, std::string_view bytes) {
    check_output(path);
    const auto partial = path + ".partial";
    RecordingFile file = make_partial(partial);
    try {
        file.write(0, bytes);
        file.sync();
        if (std::rename(partial.c_str(), path.c_str()) != 0)
            throw OutputError(fmt::format("{}: cannot be replaced ({})", path, std::strerror(errno)));
    } catch (const OutputError&) {
        std::remove(partial.c_str()); // a full disk needs the room
        throw;
    }
    sync_folder_of(path);
}

void remove_if_exists(const std::string& path) {
    if (std::remove(path.c_str()) != 0 && errno != ENOENT)
        throw InputError(fmt::format("{}: cannot be deleted ({})", path, std::strerror(errno)));
}

} // namespace tandem::recording
