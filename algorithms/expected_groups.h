// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace tandem {

/// How many groups to launch for work of which only the last frame's amount is known. Kernels stride, so that
/// any number is right; groups without work take time to come and go. The number changes seldom, so that
/// frames after another have the same commands.
class ExpectedGroups {
public:
    /// Room for twice `wanted`, at most `most`: the number of the last call where that is neither too small
    /// nor eight times too large.
    std::uint32_t enough_for(std::uint64_t wanted, std::uint32_t most) {
        wanted = std::clamp<std::uint64_t>(wanted, 1, most);
        if (groups_ < wanted || groups_ / 8 > wanted)
            groups_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, std::bit_ceil(2 * wanted)));
        return groups_;
    }

private:
    std::uint32_t groups_ = 0;
};

} // namespace tandem
