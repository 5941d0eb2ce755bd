// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace tandem {

/// What is read of a file that a user wrote: no longer, and no object or array within so many others.
constexpr std::size_t most_json_bytes = std::size_t{64} << 20;
constexpr std::size_t most_json_depth = 64;

/// The JSON of a file, which is a `what` ("scene description"). Throws InputError: one line that names the
/// file, and where in it; also for a name that an object has twice, which readers of JSON take differently
/// (RFC 8259, section 4), a number that no double holds, and what is longer or deeper than the above.
nlohmann::json read_json(const std::string& path, std::string_view what);

} // namespace tandem
