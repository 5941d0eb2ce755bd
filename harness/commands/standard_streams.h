// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>
#include <string_view>
#include <utility>

namespace tandem {

/// To be called first in main(). Descriptors 0 to 2 that were closed are taken by ones that nothing can be
/// read from, or written to where that is an error, so that no file that is opened later becomes standard
/// output. A closed pipe and a file at its limit are errors of a write from then on, not signals that end the
/// program.
void prepare_standard_streams();

/// Prints to standard output. Never fails: the first error is kept for finish_output(), and nothing more is
/// printed after it, so that measuring goes on without a reader.
void put_text(std::string_view text);

template<class... Values>
void put(fmt::format_string<Values...> format, Values&&... values) {
    put_text(fmt::format(format, std::forward<Values>(values)...));
}

/// Whether standard output is a terminal whose user has not set NO_COLOR (no-color.org).
bool prints_colour();

/// Prints to standard error; never fails.
void print_message_text(std::string_view text);

template<class... Values>
void print_message(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text(fmt::format(format, std::forward<Values>(values)...));
}

/// From now on this process prints nothing by the functions above: another one prints the same.
void silence_streams();

/// Prints to standard error, also where streams are silenced; never fails.
void print_message_text_from_every_rank(std::string_view text);

template<class... Values>
void print_message_from_every_rank(fmt::format_string<Values...> format, Values&&... values) {
    print_message_text_from_every_rank(fmt::format(format, std::forward<Values>(values)...));
}

/// Hands over what put() still holds. False when something that was put could not be written.
bool flush_output();

/// The exit code of a program that would end with `code`: 3, and a line on standard error, when something
/// that was put could not be written.
int finish_output(int code);

} // namespace tandem
