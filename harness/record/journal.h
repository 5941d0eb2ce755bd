// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem {

/// Whether a path may be a link: one that a user has given, not one that follows from such.
enum class Links { followed, refused };

/// A JSON-lines file that records are appended to, by several processes at a time: every complete line stays,
/// whatever fails. What a kill in the midst of a line has left behind is mended, under a lock, when the file
/// is opened and before each record: a line that lacks nothing but its end gets that; another is moved to
/// FILE.torn, which is said on standard error. Pipes, terminals and descriptors (/dev/stdout, /dev/fd/N) are
/// written to as they are.
class RecordFile {
public:
    /// Opens for appending, and makes the file when there is none. Throws InputError when it cannot be
    /// written or mended, and, before anything is written to it, when its first line is no JSON object. An
    /// empty path writes nowhere.
    explicit RecordFile(const std::string& path, Links links = Links::followed);
    ~RecordFile();
    RecordFile(const RecordFile&) = delete;
    RecordFile& operator=(const RecordFile&) = delete;

    /// On disk when it returns, as is the file's name. Throws OutputError when the line cannot be written
    /// whole; a part of it is taken off a file again.
    void append(const nlohmann::ordered_json& record);
    /// append(), but an OutputError is told on standard error; false then, and nothing more should be
    /// measured.
    bool append_or_report(const nlohmann::ordered_json& record);

    /// Records that this object has appended.
    std::size_t appended() const { return appended_; }
    /// Whether a record could not be written.
    bool failed() const { return failed_; }

    /// Calls with every line that is a JSON object, from the first on; with none where the file cannot be
    /// read again, as a pipe. Throws InputError when reading fails.
    void for_each(const std::function<void(const nlohmann::ordered_json&)>& visit) const;

private:
    RecordFile(const std::string& path, int file);
    void write_line(const std::string& line);

    std::string path_;
    int file_ = -1;
    bool can_be_mended_ = false; ///< a file that this object has opened itself
    bool failed_ = false;
    std::size_t appended_ = 0;
};

} // namespace tandem
