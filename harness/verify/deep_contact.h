// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/contact.h"
#include "scenes/scene.h"

#include <cstdint>
#include <optional>
#include <span>

namespace tandem {

/// A contact that is deeper than the smaller of its two bodies is long.
struct DeepContact {
    std::size_t frame = 0;
    std::uint32_t body_a = 0, tet_a = 0, body_b = 0, tet_b = 0;
    double depth = 0; ///< in the scene's unit of length; negative, as inside
    double size = 0;  ///< diagonal of the box around the smaller body
};

/// The result of a search among a frame's contacts.
struct SearchedContacts {
    std::optional<DeepContact> deepest; ///< empty if no contact is deeper than the smaller body
};

/// The deepest of these contacts of frame number `number`; empty if none is deeper than the smaller body. The
/// bodies' sizes are those of the frame.
std::optional<DeepContact> deepest_beyond_body(const Scene& scene, const Frame& frame, std::size_t number,
                                               std::span<const ContactPoint> contacts);

} // namespace tandem
