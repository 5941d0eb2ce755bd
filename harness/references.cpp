// SPDX-License-Identifier: MIT
#include "harness/references.h"

#include <algorithm>

namespace tandem {

const ReferenceAnswer& References::answer(const Geometry& geometry, const ContactSettings& contacts,
                                          std::size_t index) {
    const Key key{geometry, contacts};
    auto found =
        std::find_if(known_.begin(), known_.end(), [&](const auto& entry) { return entry.first == key; });
    if (found == known_.end()) {
        known_.emplace_back(key, std::vector<std::optional<ReferenceAnswer>>(range_.frames.size()));
        found = known_.end() - 1;
    }
    auto& answer = found->second[index];
    if (!answer)
        answer = reference(scene_, range_.frames[index], geometry, true, reference_method(scene_), contacts);
    return *answer;
}

} // namespace tandem
