// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace tandem {

/// "GPU-01234567-89ab-cdef-0123-456789abcdef", as NVIDIA's tools write it.
inline std::string uuid_text(const std::array<unsigned char, 16>& bytes) {
    std::string text = "GPU-";
    for (std::size_t i = 0; i < bytes.size(); ++i)
        text += fmt::format("{}{:02x}", i == 4 || i == 6 || i == 8 || i == 10 ? "-" : "", bytes[i]);
    return text;
}

/// What a record has in place of a UUID or PCI address: 16 hexadecimal digits, FNV-1a (Fowler, Noll and Vo)
/// of 64 bits over its characters. It tells the GPUs of records apart; it names none to whoever does not know
/// its UUID.
inline std::string hardware_digest(std::string_view hardware) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : hardware) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash);
}

} // namespace tandem
