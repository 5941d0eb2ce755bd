// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace tandem {

/// What one of several devices does of a frame. A pair of bodies belongs to the first share that owns one of
/// them, so that shares together have every pair once.
struct Subdomain {
    std::vector<std::uint32_t> own; ///< moving bodies, neighbours beside each other
    std::vector<std::uint32_t>
        ghosts; ///< fixed ones, and those of later shares, that may meet one of its own
};

/// What a body is to a share.
enum class Role : std::uint8_t { none, ghost, own };

/// By body.
std::vector<Role> roles_of(const Subdomain& subdomain, std::size_t bodies);

} // namespace tandem
