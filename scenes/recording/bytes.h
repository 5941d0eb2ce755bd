// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace tandem::recording {

/// Appends an unsigned integer, lowest byte first on every machine.
template<class Integer>
void put(std::string& out, Integer value) {
    static_assert(std::is_unsigned_v<Integer>, "floating-point numbers go through put_float and put_double");
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
        out.push_back(static_cast<char>(static_cast<unsigned char>(value >> (8 * i) & 0xff)));
}

inline void put_float(std::string& out, float value) { put(out, std::bit_cast<std::uint32_t>(value)); }
inline void put_double(std::string& out, double value) { put(out, std::bit_cast<std::uint64_t>(value)); }

/// CRC-32 of zlib and PNG, which detects every change within 32 adjacent bits. `start` is the checksum of the
/// preceding bytes.
std::uint32_t checksum(std::string_view bytes, std::uint32_t start = 0);

/// `bytes` followed by their checksum.
std::string sealed(std::string bytes);

} // namespace tandem::recording
