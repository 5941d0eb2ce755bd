// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace tandem::recording {

/// An open file. A failure is an InputError "PATH: what (reason)", of writing an OutputError.
class File {
public:
    /// How a file is opened: an existing one to read; a new one, which must not exist; an existing one to
    /// read and write; one that is made empty. The last three take a lock that ends with the process.
    enum class Mode { read, create, update, replace };

    File(const std::string& path, Mode mode);
    ~File();
    File(File&& other) noexcept
        : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
    File& operator=(File&& other) noexcept {
        std::swap(path_, other.path_);
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }

    const std::string& path() const { return path_; }
    std::uint64_t size() const;
    /// Exactly `bytes` bytes from `offset`. Threads may call it at once.
    std::string read(std::uint64_t offset, std::size_t bytes) const;
    void write(std::uint64_t offset, std::string_view bytes);
    void truncate(std::uint64_t size);
    /// Returns when everything written survives a loss of power.
    void sync();

private:
    [[noreturn]] void fail(std::string_view what) const;
    [[noreturn]] void fail_writing(std::string_view what) const;

    std::string path_;
    int descriptor_;
};

/// All of a file; throws InputError.
std::string read_whole(const std::string& path);

/// Gives `path` the content `bytes` so that a crash at any moment leaves the old or the new content, whole:
/// written to PATH.partial, which is made for it and no link, synced, renamed. Throws InputError when that
/// cannot be made, OutputError when it cannot be written.
void replace_whole(const std::string& path, std::string_view bytes);

/// Deletes a file when there is one.
void remove_if_there(const std::string& path);

} // namespace tandem::recording
