// SPDX-License-Identifier: MIT
#include "algorithms/distributed/share.h"

namespace tandem {

std::vector<Role> roles_in(const Share& share, std::size_t bodies) {
    std::vector<Role> roles(bodies, Role::none);
    for (const auto body : share.others) roles[body] = Role::other;
    for (const auto body : share.own) roles[body] = Role::own;
    return roles;
}

} // namespace tandem
