// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace tandem {

/// Call this first in main(). Descriptors 0 to 2 that are closed are opened on /dev/null, so that no file
/// that is opened later becomes a standard stream; writing to such a standard output stays an error. From
/// then on a closed pipe and a file at its size limit make a write fail and do not end the program by a
/// signal.
void prepare_standard_streams();

/// Prints to standard output. Never fails: finish_output() reports the first error, and nothing more is
/// printed after it, so that measuring goes on without a reader.
void put_text(std::string_view text);

template<class... Values>
void put(fmt::format_string<Values...> format, Values&&... values) {
    put_text(fmt::format(format, std::forward<Values>(values)...));
}

/// Whether standard output is a terminal and NO_COLOR is not set (no-color.org).
bool prints_colour();

/// Prints to standard error; never fails.
void print_message_text(std::string_view text);

template<class... Values>
void print_message(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text(fmt::format(format, std::forward<Values>(values)...));
}

/// From now on the functions above print nothing. For ranks: another process prints the same text.
void silence_streams();

/// Prints to standard error, even after silence_streams(); never fails.
void print_message_text_from_every_rank(std::string_view text);

template<class... Values>
void print_message_from_every_rank(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text_from_every_rank(fmt::format(format, std::forward<Values>(values)...));
}

/// Writes the buffered output of put(). Returns false when any of the output could not be written.
bool flush_output();

/// The exit code of a program that would end with `code`. Returns 3 and prints an error message when any of
/// the output of put() could not be written.
int finish_output(int code);

} // namespace tandem
