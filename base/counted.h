// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace tandem {

/// "1 cell", "2 cells", "2 bodies". `plural`: empty: `noun` with an s.
inline std::string counted(std::uint64_t count, std::string_view noun, std::string_view plural = {}) {
    if (count == 1) return fmt::format("1 {}", noun);
    return plural.empty() ? fmt::format("{} {}s", count, noun) : fmt::format("{} {}", count, plural);
}

/// "1 cell is", "2 cells are".
inline std::string counted_are(std::uint64_t count, std::string_view noun) {
    return counted(count, noun) + (count == 1 ? " is" : " are");
}

} // namespace tandem
