// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace tandem {

// Parts of a RecordFile, each of an open file that can be read and is called `path` in errors. Where nothing
// else is said they throw OutputError.

/// Bytes of the file.
std::size_t size_of(int file, const std::string& path);

/// The line that begins `at` so many bytes, without its end; false behind the last byte.
bool read_line(int file, const std::string& path, std::size_t at, std::string& line);

/// Throws InputError unless the file is empty or its first line is a JSON object, or the beginning of one and
/// all there is: zeros behind it count as torn, and nothing but zeros as well.
void check_first_line(int file, const std::string& path);

/// For a file whose last byte ends no line: ends a last line that is a whole JSON object; moves any other to
/// PATH.torn, which is synchronised before it is taken off the file, and says so on standard error. A
/// PATH.torn that is there is added to; one that is no file, links included, is an error.
void mend_last_line(int file, const std::string& path);

} // namespace tandem
