// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tandem {

/// Chooses the number of groups for a launch whose amount of work is known from the last frame only. Kernels
/// have strided loops, so that any number is correct, but groups without work cost time. The number rarely
/// changes, so that consecutive frames have the same commands.
class ExpectedGroups {
public:
    /// Returns the number of the last call if it is between `wanted` and 8 times `wanted`. Otherwise a power
    /// of two of at least twice `wanted`, limited to `most`.
    std::uint32_t groups_for(std::uint64_t wanted, std::uint32_t most) {
        wanted = std::clamp<std::uint64_t>(wanted, 1, most);
        if (groups_ < wanted || groups_ / 8 > wanted)
            groups_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, std::bit_ceil(2 * wanted)));
        return groups_;
    }

private:
    std::uint32_t groups_ = 0;
};

} // namespace tandem
