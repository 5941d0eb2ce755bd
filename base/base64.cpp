// SPDX-License-Identifier: MIT
#include "base/base64.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace tandem::base64 {

namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr auto digits = [] {
    std::array<int, 256> table{};
    table.fill(-1);
    for (std::size_t i = 0; i < alphabet.size(); ++i)
        table[static_cast<unsigned char>(alphabet[i])] = static_cast<int>(i);
    return table;
}();

} // namespace

/// Accepts padding between groups: VTK encodes a header and its data as separate base64 texts.
std::optional<std::string> decode(std::string_view text, std::size_t limit) {
    std::string bytes;
    bytes.reserve(limit);
    std::uint32_t group = 0;
    int filled = 0, padding = 0;
    for (const char c : text) {
        if (bytes.size() >= limit || c == '<') break;
        if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
        const int digit = digits[static_cast<unsigned char>(c)];
        if (c != '=' && (digit < 0 || padding > 0)) return std::nullopt;
        padding += c == '=' ? 1 : 0;
        group = group << 6 | static_cast<std::uint32_t>(c == '=' ? 0 : digit);
        if (++filled < 4) continue;
        if (padding > 2) return std::nullopt;
        for (int i = 0; i < 3 - padding; ++i)
            bytes.push_back(static_cast<char>(group >> (16 - 8 * i) & 0xff));
        group = 0;
        filled = padding = 0;
    }
    if (bytes.size() > limit) bytes.resize(limit);
    return bytes;
}

std::string encode(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        const auto filled = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t j = 0; j < filled; ++j)
            group |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + j])) << (16 - 8 * j);
        for (std::size_t j = 0; j < 4; ++j)
            text.push_back(j <= filled ? alphabet[group >> (18 - 6 * j) & 63] : '=');
    }
    return text;
}

} // namespace tandem::base64
