// SPDX-License-Identifier: MIT
#pragma once

#include <compare>
#include <cstdint>

namespace tandem {

/// Two bodies whose volumes may overlap, or a body and itself; a <= b.
struct BodyPair {
    std::uint32_t a = 0; ///< index into Scene::bodies
    std::uint32_t b = 0; ///< index into Scene::bodies

    /// Orders by a, then b.
    auto operator<=>(const BodyPair&) const = default;
};

} // namespace tandem
