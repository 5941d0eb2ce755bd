// SPDX-License-Identifier: MIT
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace tandem {

/// A file that is written as a whole or not at all. Until finish(), the text is in a temporary file beside
/// it, PATH.PID, so that nobody takes a part, or nothing, for the whole. Pipes and terminals are written
/// directly.
class WholeFile {
public:
    /// Opens the temporary file. Throws InputError when it cannot be written, and as check_output() does
    /// (files_in_use.h). With an empty path nothing is written.
    explicit WholeFile(const std::string& path);
    /// Deletes the temporary file if the file is not finished.
    ~WholeFile();
    WholeFile(const WholeFile&) = delete;
    WholeFile& operator=(const WholeFile&) = delete;

    explicit operator bool() const { return file_ != nullptr; }
    /// Appends a text. Throws OutputError.
    void write(std::string_view text);
    /// Replaces the file at the path, or makes it; call it once, last. Throws OutputError.
    void finish();

private:
    [[noreturn]] void fail();
    void discard();

    std::string path_, target_, temporary_; ///< target: what the path names, through links
    std::FILE* file_ = nullptr;
};

} // namespace tandem
