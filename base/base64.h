// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace tandem::base64 {

/// Decodes until `limit` bytes are decoded, the text ends, or a '<' follows. Padding may stand between
/// groups, because VTK encodes headers separately. Returns no value when the text is not base64.
std::optional<std::string> decode(std::string_view text, std::size_t limit);

/// The base64 text of `bytes`, padded, without line breaks.
std::string encode(std::string_view bytes);

} // namespace tandem::base64
