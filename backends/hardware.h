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

/// Replaces a UUID or PCI address in records: 16 hexadecimal digits, the 64-bit FNV-1a hash (Fowler, Noll and
/// Vo) of its characters. It distinguishes GPUs without disclosing their UUIDs.
inline std::string hardware_digest(std::string_view hardware) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : hardware) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash);
}

} // namespace tandem
