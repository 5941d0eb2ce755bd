// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace tandem {

/// The bodies that one of several devices processes. A pair of bodies belongs to the first subdomain that
/// owns one of the two, so that exactly one subdomain has each pair.
struct Subdomain {
    std::vector<std::uint32_t> own; ///< moving bodies, spatial neighbours close together
    /// Fixed bodies, and bodies of later subdomains, that may overlap one of `own`.
    std::vector<std::uint32_t> ghosts;
};

/// The role of a body in a subdomain.
enum class Role : std::uint8_t { none, ghost, own };

/// The roles of all `bodies` bodies of a scene, by body.
std::vector<Role> roles_of(const Subdomain& subdomain, std::size_t bodies);

} // namespace tandem
