// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace tandem::recording {

/// An open file. Throws InputError "PATH: what (reason)", or OutputError when writing fails.
class RecordingFile {
public:
    /// read: an existing file. create: a new file, which must not exist. update: an existing file, to read
    /// and write. replace: an existing or new file, which is truncated unless it is an input or a file of
    /// records (base/files_in_use.h). All but read lock the file until the process ends.
    enum class Mode { read, create, update, replace };

    RecordingFile(const std::string& path, Mode mode);
    ~RecordingFile();
    RecordingFile(RecordingFile&& other) noexcept
        : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
    RecordingFile& operator=(RecordingFile&& other) noexcept {
        std::swap(path_, other.path_);
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }

    const std::string& path() const { return path_; }
    std::uint64_t size() const;
    /// Reads exactly `bytes` bytes from `offset`. Thread-safe.
    std::string read(std::uint64_t offset, std::size_t bytes) const;
    void write(std::uint64_t offset, std::string_view bytes);
    void truncate(std::uint64_t size);
    /// Makes all written data survive a loss of power before it returns.
    void sync();

private:
    void replace_content();
    [[noreturn]] void fail(std::string_view what) const;
    [[noreturn]] void fail_writing(std::string_view what) const;

    std::string path_;
    int descriptor_;
};

/// The complete content of a file; throws InputError.
std::string read_whole(const std::string& path);

/// Replaces the content of `path` atomically: a crash leaves the complete old or new content. Writes and
/// syncs the new file PATH.partial, which must not be a link, then renames it. Throws InputError for an input
/// and a file of records, and when that file cannot be created, OutputError when it cannot be written.
void replace_whole(const std::string& path, std::string_view bytes);

/// Deletes a file if it exists.
void remove_if_exists(const std::string& path);

} // namespace tandem::recording
