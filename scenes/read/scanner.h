// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace tandem::read {

/// The line, from 1, of byte `at`. Only errors call it, so that scanning needs no counter.
std::size_t line_of(std::string_view text, std::size_t at);

/// Whether the text of a number is closer to 0 than any double but 0. from_chars only tells that it is out of
/// range.
bool is_underflow(std::string_view number);

/// `token` in quotes, for messages: at most 40 characters, '?' for others than printable ASCII.
std::string in_quotes(std::string_view token);

/// Reads text token by token. Cursor has the same functions get, check_count and fail, so that one template
/// reads a layout in both encodings.
class Scanner {
public:
    /// `comment` starts a comment up to the end of the line; '\0': no comments.
    Scanner(std::string_view text, const std::string& source, char comment = '\0', std::size_t at = 0)
        : text_(text), source_(source), comment_(comment), at_(at), token_(at) {}

    /// Skips blanks and comments; true at the end of the text.
    bool done();
    /// The next token. Fails at the end of the text; the message calls the token `what`.
    std::string_view token(std::string_view what);
    /// Returns and skips the rest of the current line.
    std::string_view line();
    /// The next number: an integer, or a finite floating-point number.
    template<class T>
    T get(std::string_view what);
    /// Fails unless the rest of the text can contain n items of `values` numbers each.
    void check_count(std::uint64_t n, std::size_t values, std::size_t bytes, std::string_view what) const;
    /// Throws InputError with the position of the last token.
    [[noreturn]] void fail(std::string_view what, std::string_view remedy) const;

    std::string_view text() const { return text_; }
    const std::string& source() const { return source_; }
    std::size_t at() const { return at_; }
    void seek(std::size_t at) { at_ = token_ = at; }
    /// Later errors give a byte instead of a line, for files with text and binary data.
    void count_bytes() { bytes_ = true; }

private:
    [[noreturn]] void fail_number(std::string_view token, std::string_view what, std::errc error) const;
    [[noreturn]] void fail_finite(std::string_view token, std::string_view what) const;

    std::string_view text_;
    std::string source_;
    char comment_;
    bool bytes_ = false;
    std::size_t at_;
    std::size_t token_; ///< position of the last token
};

template<class T>
T Scanner::get(std::string_view what) {
    const auto word = token(what);
    const char* first = word.data();
    const char* last = first + word.size();
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++first; // from_chars takes no plus sign
    T value{};
    const auto [end, error] = std::from_chars(first, last, value);
    if constexpr (std::is_floating_point_v<T>)
        if (error == std::errc::result_out_of_range && end == last && is_underflow(word)) return T(0);
    if (error != std::errc() || end != last) fail_number(word, what, error);
    if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(value)) fail_finite(word, what);
    return value;
}

} // namespace tandem::read
