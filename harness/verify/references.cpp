// SPDX-License-Identifier: MIT
#include "harness/verify/references.h"

#include "scenes/digest.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

nlohmann::json kept_digest(const Digest& digest) { return {digest.count, digest.a, digest.b}; }

Digest digest_kept_as(const nlohmann::json& words) {
    return {words.at(0).get<std::uint64_t>(), words.at(1).get<std::uint64_t>(),
            words.at(2).get<std::uint64_t>()};
}

} // namespace

References::References(const Scene& scene, const FrameRange& range, const std::filesystem::path& folder)
    : scene_(scene),
      range_(range),
      kept_(folder, fmt::format("references of {} {:016x}", scene.key, scene.digest)) {}

/// The frame by what is in it, whatever its number: flawed tetrahedra may be skipped.
std::string References::question(const Key& key) const {
    const auto& [geometry, contacts, index] = key;
    return fmt::format(
        "frame {:016x}, k {} {}, precision {}, rounding {}, placement {}, origin {}, rule {}, decision {}",
        digest_of(*range_.frame(index)), geometry.k, geometry.coordinate_axes,
        static_cast<int>(geometry.precision), static_cast<int>(geometry.rounding),
        static_cast<int>(geometry.placement), static_cast<int>(geometry.origin),
        static_cast<int>(contacts.rule), static_cast<int>(contacts.decision));
}

const ReferenceAnswer& References::answer(const Geometry& geometry, const ContactSettings& contacts,
                                          std::size_t index) {
    const Key key{geometry, contacts, index};
    if (last_ && last_->first == key) return last_->second;
    last_.reset(); // before the next takes memory
    const auto frame = range_.frame(index, geometry.origin);
    last_.emplace(key, reference(scene_, *frame, geometry, true, reference_method(scene_), contacts));
    return last_->second;
}

ReferenceDigests References::digests(const Geometry& geometry, const ContactSettings& contacts,
                                     std::size_t index) {
    const Key key{geometry, contacts, index};
    const auto found = std::ranges::find(known_, key, &std::pair<Key, ReferenceDigests>::first);
    if (found != known_.end()) return found->second;
    const auto asked = question(key);
    ReferenceDigests digests;
    const bool is_kept = kept_.take(asked, [&](const nlohmann::json& value) {
        digests = {digest_kept_as(value.at("pairs")), digest_kept_as(value.at("contacts"))};
    });
    if (!is_kept) {
        const auto& computed = answer(geometry, contacts, index);
        digests = {computed.digest, computed.contact_digest};
        kept_.keep(asked,
                   {{"pairs", kept_digest(digests.pairs)}, {"contacts", kept_digest(digests.contacts)}});
    }
    known_.emplace_back(key, digests);
    return digests;
}

} // namespace tandem
