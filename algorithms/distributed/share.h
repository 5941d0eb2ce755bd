// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace tandem {

/// What one of several devices does of a frame. A pair of bodies belongs to the first share that owns one of
/// them, so that shares together have every pair once.
struct Share {
    std::vector<std::uint32_t> own; ///< moving bodies, neighbours beside each other
    std::vector<std::uint32_t>
        others; ///< fixed ones, and those of later shares, that may meet one of its own
};

/// What a body is to a share.
enum class Role : std::uint8_t { none, other, own };

/// By body.
std::vector<Role> roles_in(const Share& share, std::size_t bodies);

} // namespace tandem
