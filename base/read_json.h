// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace tandem {

/// Limits for files that users write: size, and levels of nested objects and arrays.
constexpr std::size_t max_json_bytes = std::size_t{64} << 20;
constexpr std::size_t max_json_depth = 64;

/// Reads the JSON of a file; `what` is its kind ("scene description"). Throws InputError: one line with the
/// file and the position. Errors include a repeated name in an object, which readers treat differently (RFC
/// 8259, section 4), a number beyond double, and a file beyond the limits.
nlohmann::json read_json(const std::string& path, std::string_view what);

} // namespace tandem
