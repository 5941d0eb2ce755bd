// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace tandem {

/// 64-bit digest of a sequence of values: FNV-1a (Fowler, Noll and Vo) over 64-bit words. A final mix of each
/// word makes high bits count too. Not cryptographic.
class Digester {
public:
    void add(std::uint64_t word) {
        state_ = (state_ ^ word) * 0x100000001b3u;
        state_ ^= state_ >> 32;
    }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number + 0.0)); } // turns -0 into 0
    /// Adds the length too, so that two texts in a row differ from one.
    void add(std::string_view text) {
        add(std::uint64_t{text.size()});
        for (const char c : text) add(std::uint64_t{static_cast<unsigned char>(c)});
    }
    std::uint64_t value() const { return state_; }

private:
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// 64-bit digest of a text.
inline std::uint64_t digest_of(std::string_view text) {
    Digester digester;
    digester.add(text);
    return digester.value();
}

} // namespace tandem
