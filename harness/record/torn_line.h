// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace tandem {

// Parts of RecordFile. `file` is an open, readable file; errors name it by `path`. All functions throw
// OutputError on failure, unless stated otherwise.

/// Size of the file in bytes.
std::size_t size_of(int file, const std::string& path);

/// Reads the line that begins at byte `at`, without its newline; false at the end of the file.
bool read_line(int file, const std::string& path, std::size_t at, std::string& line);

/// Throws InputError unless the file is empty or its first line is a JSON object. A torn object that is the
/// whole file is accepted too. An object followed by zeros, or zeros alone, count as torn.
void check_first_line(int file, const std::string& path);

/// Repairs a file that does not end with a newline. A last line that is a whole JSON object gets its newline.
/// Any other moves to the end of PATH.torn, which is synchronised first, with a message on standard error. It
/// is an error when PATH.torn is a link or no regular file.
void repair_last_line(int file, const std::string& path);

} // namespace tandem
