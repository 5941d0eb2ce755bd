// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace tandem {

/// Whether a path may be a link. Paths that a user gives may be links, paths derived from them may not.
enum class Links { followed, refused };

/// A JSON-lines file to which several processes may append records at the same time. Complete lines survive
/// every failure. A killed process can leave a torn last line. The class repairs it, under a lock, when it
/// opens the file and before each record: a line that lacks only its newline gets one; any other moves to
/// FILE.torn, with a message on standard error. Pipes, terminals and descriptors (/dev/stdout, /dev/fd/N) are
/// written to without repair.
class RecordFile {
public:
    /// Opens the file for appending, or creates it. Throws InputError when the file cannot be written or
    /// repaired. Throws InputError before any write when the first line is not a JSON object. With an empty
    /// path, append() does nothing.
    explicit RecordFile(const std::string& path, Links links = Links::followed);
    ~RecordFile();
    RecordFile(const RecordFile&) = delete;
    RecordFile& operator=(const RecordFile&) = delete;

    /// Appends a record and synchronises the file to disk. Throws OutputError when the whole line cannot be
    /// written; a partial line is removed from a regular file.
    void append(const nlohmann::ordered_json& record);
    /// As append(), but prints an OutputError to standard error and returns false. The caller should then
    /// stop measuring.
    bool append_or_report(const nlohmann::ordered_json& record);

    /// Number of records that this object has appended.
    std::size_t appended() const { return appended_; }
    /// Whether a record could not be written.
    bool failed() const { return failed_; }

    /// Calls `visit` with every line that is a JSON object, in file order. Does nothing when the file cannot
    /// be read back, such as a pipe. Throws InputError when reading fails.
    void for_each(const std::function<void(const nlohmann::ordered_json&)>& visit) const;

private:
    RecordFile(const std::string& path, int file);
    void write_line(const std::string& line);

    std::string path_;
    int file_ = -1;
    bool is_repairable_ = false; ///< a regular file that this object has opened itself
    bool failed_ = false;
    std::size_t appended_ = 0;
};

} // namespace tandem
