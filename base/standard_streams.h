// SPDX-License-Identifier: MIT
#pragma once

#include "base/text_lines.h"

#include <cstddef>
#include <fmt/format.h>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tandem {

/// Call this first in main(). Descriptors 0 to 2 that are closed are opened on /dev/null, so that no file
/// that is opened later becomes a standard stream; writing to such a standard output stays an error. From
/// then on a closed pipe and a file at its size limit make a write fail and do not end the program by a
/// signal.
void prepare_standard_streams();

/// Writes bytes for another program to standard output, as they are. Never fails, as put_text().
void put_bytes(std::string_view bytes);

/// A value for a format: a text without control characters, because it may be a file's words (visible()); any
/// other value as it is.
template<class Value>
auto printable(const Value& value) {
    if constexpr (std::is_convertible_v<const Value&, std::string_view>)
        return visible(value);
    else
        return value;
}

/// A text of a format and values that are printable(). Control characters of the format itself stay.
template<class... Values>
std::string printed(fmt::format_string<Values...> format, const Values&... values) {
    return fmt::format(fmt::runtime(format), printable(values)...);
}

/// Prints a text of several lines to standard output, such as a table: line ends, tabs and colours (SGR)
/// stay, other control characters do not. Never fails: finish_output() reports the first error, and nothing
/// more is printed after it, so that measuring goes on without a reader.
void put_text(std::string_view text);

/// Prints a line of a format; the values are printable().
template<class... Values>
void put(fmt::format_string<Values...> format, Values&&... values) {
    put_text(printed<Values...>(format, values...));
}

/// Whether standard output is a terminal and NO_COLOR is not set (no-color.org).
bool prints_colour();

/// The width of lines on standard output, in characters: that of its terminal, else $COLUMNS, else `usual`.
/// At least 40.
std::size_t output_columns(std::size_t usual = 100);

/// The width of the terminal of a descriptor; 0 when it is no terminal, or has no size.
std::size_t terminal_columns(int descriptor);

/// Prints to standard error; never fails.
void print_message_text(std::string_view text);

template<class... Values>
void print_message(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text(printed<Values...>(format, values...));
}

/// From now on the functions above print nothing. For ranks: another process prints the same text.
void silence_streams();

/// Prints to standard error, even after silence_streams(); never fails.
void print_message_text_from_every_rank(std::string_view text);

template<class... Values>
void print_message_from_every_rank(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text_from_every_rank(printed<Values...>(format, values...));
}

/// Writes the buffered output of put(). Returns false when any of the output could not be written.
bool flush_output();

/// The exit code of a program that would end with `code`. Returns 3 and prints an error message when any of
/// the output of put() could not be written, unless the reader has closed the pipe.
int finish_output(int code);

} // namespace tandem
