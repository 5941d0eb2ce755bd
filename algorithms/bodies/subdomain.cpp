// SPDX-License-Identifier: MIT
#include "algorithms/bodies/subdomain.h"

namespace tandem {

std::vector<Role> roles_of(const Subdomain& subdomain, std::size_t bodies) {
    std::vector<Role> roles(bodies, Role::none);
    for (const auto body : subdomain.ghosts) roles[body] = Role::ghost;
    for (const auto body : subdomain.own) roles[body] = Role::own;
    return roles;
}

} // namespace tandem
