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

/// The line, from 1, of byte `at`. Counted only for errors, so that scanning needs no counter.
std::size_t line_of(std::string_view text, std::size_t at);

/// `token` between quotes, shortened and printable.
std::string in_quotes(std::string_view token);

/// Walks over text token by token. Shares get, room and fail with Cursor, so that one template reads a layout
/// in both encodings.
class Scanner {
public:
    /// `comment` starts a comment that ends with its line; '\0' for none.
    Scanner(std::string_view text, const std::string& source, char comment = '\0', std::size_t at = 0)
        : text_(text), source_(source), comment_(comment), at_(at), token_(at) {}

    /// Skips blanks and comments; true at the end of the text.
    bool done();
    /// The next token; `what` names it when the text ends before it.
    std::string_view token(std::string_view what);
    /// The rest of the current line, which it passes.
    std::string_view line();
    /// The next number, whole or finite by T.
    template<class T>
    T get(std::string_view what);
    /// Fails unless n items of `values` numbers each can still follow.
    void room(std::uint64_t n, std::size_t values, std::size_t bytes, std::string_view what) const;
    /// Throws InputError that points at the last token.
    [[noreturn]] void fail(std::string_view what, std::string_view remedy) const;

    std::string_view text() const { return text_; }
    const std::string& source() const { return source_; }
    std::size_t at() const { return at_; }
    void seek(std::size_t at) { at_ = token_ = at; }
    /// Errors name a byte from here on: the file mixes text with binary data.
    void count_bytes() { bytes_ = true; }

private:
    [[noreturn]] void fail_number(std::string_view token, std::string_view what, std::errc error) const;
    [[noreturn]] void fail_finite(std::string_view token, std::string_view what) const;

    std::string_view text_;
    std::string source_;
    char comment_;
    bool bytes_ = false;
    std::size_t at_;
    std::size_t token_; ///< where the last token starts
};

template<class T>
T Scanner::get(std::string_view what) {
    const auto word = token(what);
    const char* first = word.data();
    const char* last = first + word.size();
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') ++first; // from_chars takes no plus sign
    T value{};
    const auto [end, error] = std::from_chars(first, last, value);
    if (error != std::errc() || end != last) fail_number(word, what, error);
    if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(value)) fail_finite(word, what);
    return value;
}

} // namespace tandem::read
