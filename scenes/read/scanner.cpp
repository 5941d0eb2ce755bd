// SPDX-License-Identifier: MIT
#include "scenes/read/scanner.h"

#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <locale>
#include <sstream>

namespace tandem::read {

namespace {

bool blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

} // namespace

std::size_t line_of(std::string_view text, std::size_t at) {
    const auto before = text.substr(0, at);
    return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

bool is_underflow(std::string_view number) {
    std::istringstream in{std::string(number)};
    in.imbue(std::locale::classic());
    double value = 1;
    return in >> value && std::fabs(value) < 1; // a stream reads the nearest double, and fails on overflow
}

/// Messages are one line of printable text for any content of the file.
std::string in_quotes(std::string_view token) {
    constexpr std::size_t longest = 40;
    std::string shown(token.substr(0, longest));
    for (char& c : shown)
        if (c < ' ' || c > '~') c = '?';
    return "'" + shown + (token.size() > longest ? "...'" : "'");
}

bool Scanner::done() {
    while (at_ < text_.size()) {
        if (comment_ != '\0' && text_[at_] == comment_)
            at_ = std::min(text_.find('\n', at_), text_.size());
        else if (blank(text_[at_]))
            ++at_;
        else
            return false;
    }
    return true;
}

std::string_view Scanner::token(std::string_view what) {
    const bool ended = done();
    token_ = at_;
    if (ended) fail(fmt::format("the file ends before {}", what), "it is truncated: copy or export it again");
    while (at_ < text_.size() && !blank(text_[at_])) ++at_;
    return text_.substr(token_, at_ - token_);
}

std::string_view Scanner::line() {
    token_ = at_;
    const auto end = std::min(text_.find('\n', at_), text_.size());
    at_ = std::min(end + 1, text_.size());
    const bool windows = end > token_ && text_[end - 1] == '\r';
    return text_.substr(token_, end - token_ - (windows ? 1 : 0));
}

void Scanner::check_count(std::uint64_t n, std::size_t values, std::size_t, std::string_view what) const {
    // A number has at least one digit and a separator; the last one may have no separator.
    const std::uint64_t left = (text_.size() - at_ + 1) / (2 * values);
    if (n > left || n > std::numeric_limits<std::uint32_t>::max())
        fail(fmt::format("{} {} announced, but the rest of the file can contain at most {}", n, what, left),
             "correct the count or export the file again");
}

void Scanner::fail(std::string_view what, std::string_view remedy) const {
    if (bytes_) throw InputError(fmt::format("{}: byte {}: {}; {}", source_, token_, what, remedy));
    throw InputError(fmt::format("{}:{}: {}; {}", source_, line_of(text_, token_), what, remedy));
}

void Scanner::fail_number(std::string_view token, std::string_view what, std::errc error) const {
    if (error == std::errc::result_out_of_range)
        fail(fmt::format("{} {} is out of range", what, in_quotes(token)), "repair the mesh");
    fail(fmt::format("expected {}, found {}", what, in_quotes(token)), "correct the file or export it again");
}

void Scanner::fail_finite(std::string_view token, std::string_view what) const {
    fail(fmt::format("{} {} is not finite", what, in_quotes(token)), "repair the mesh");
}

} // namespace tandem::read
