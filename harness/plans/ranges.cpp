// SPDX-License-Identifier: MIT
#include "harness/plans/ranges.h"

#include "base/error.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace tandem {

namespace {

constexpr std::size_t most_values = 10000;
/// Below this bound a double represents every whole number exactly.
constexpr double largest_whole = 9007199254740992.0; // 2^53

std::optional<double> number(std::string_view text) {
    double value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool whole_text = result.ec == std::errc{} && result.ptr == text.data() + text.size();
    return whole_text && std::isfinite(value) && value >= 0 ? std::optional(value) : std::nullopt;
}

std::string text_of(double value) {
    return value == std::floor(value) && value < largest_whole ? fmt::format("{:.0f}", value)
                                                               : fmt::format("{}", value);
}

} // namespace

std::vector<std::string> expand_range(std::string_view text, const std::string& whole) {
    const auto dots = text.find("..");
    if (dots == std::string_view::npos) return {std::string(text)};
    const auto rest = text.substr(dots + 2);
    const auto sign = rest.find_first_of("*:");
    const bool times = sign != std::string_view::npos && rest[sign] == '*';
    const auto first = number(text.substr(0, dots)), last = number(rest.substr(0, sign));
    const auto step = sign == std::string_view::npos ? std::optional(1.0) : number(rest.substr(sign + 1));
    if (!first || !last || !step)
        throw InputError(
            fmt::format("{}: a range is A..B, A..B:STEP or A..B*FACTOR, of numbers from 0", whole));
    if (*last < *first || *step <= (times ? 1 : 0) || (times && *first <= 0))
        throw InputError(
            fmt::format("{}: '{}' never ends; give A up to B, a step above 0 or a factor above 1, and "
                        "with a factor A above 0",
                        whole, text));
    std::vector<std::string> values;
    for (std::size_t i = 0;; ++i) {
        // Each value is computed from the first, so that rounding errors do not add up. The tolerance keeps
        // B.
        const auto n = static_cast<double>(i);
        const double value = times ? *first * std::pow(*step, n) : *first + *step * n;
        if (value > *last * (1 + 1e-12)) return values;
        if (values.size() == most_values)
            throw InputError(fmt::format("{}: '{}' is more than {} values", whole, text, most_values));
        values.push_back(text_of(value));
    }
}

} // namespace tandem
