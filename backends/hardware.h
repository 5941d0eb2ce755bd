// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <fmt/format.h>
#include <string>

namespace tandem {

/// "GPU-01234567-89ab-cdef-0123-456789abcdef", as NVIDIA's tools write it.
inline std::string uuid_text(const std::array<unsigned char, 16>& bytes) {
    std::string text = "GPU-";
    for (std::size_t i = 0; i < bytes.size(); ++i)
        text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes[i]);
    return text;
}

} // namespace tandem
