// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tandem::report {

/// Bytes in letters, digits, + and /, ended by = (RFC 4648): four for three.
std::string base64(std::span<const std::byte> bytes);

template<class Number>
std::string base64(const std::vector<Number>& numbers) {
    return base64(std::as_bytes(std::span(numbers)));
}

} // namespace tandem::report
