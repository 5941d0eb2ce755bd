// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames.h"
#include "harness/reference.h"

#include <optional>

namespace tandem {

/// Answers of the reference per frame, computed once for each geometry.
class References {
public:
    References(const Scene& scene, const FrameRange& range) : scene_(scene), range_(range) {}

    /// Of frame number `index` of the range; serial host code that may take minutes on a large scene.
    const ReferenceAnswer& answer(const Geometry& geometry, const ContactSettings& contacts,
                                  std::size_t index);

private:
    const Scene& scene_;
    const FrameRange& range_;
    using Key = std::pair<Geometry, ContactSettings>;
    std::vector<std::pair<Key, std::vector<std::optional<ReferenceAnswer>>>> known_;
};

} // namespace tandem
