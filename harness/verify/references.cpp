// SPDX-License-Identifier: MIT
#include "harness/verify/references.h"

#include "scenes/digest.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

nlohmann::json digest_json(const Digest& digest) { return {digest.count, digest.a, digest.b}; }

Digest read_digest(const nlohmann::json& words) {
    return {words.at(0).get<std::uint64_t>(), words.at(1).get<std::uint64_t>(),
            words.at(2).get<std::uint64_t>()};
}

} // namespace

References::References(const Scene& scene, const FrameRange& range, const std::filesystem::path& folder)
    : scene_(scene),
      range_(range),
      cache_(folder, fmt::format("references of {} {:016x}", scene.key, scene.digest)) {}

/// Identifies the frame by its content, because its flawed tetrahedra may be skipped or not.
std::string References::cache_key(const Key& key) const {
    const auto& [geometry, contacts, index] = key;
    const bool moves = geometry.motion == Motion::linear;
    return fmt::format(
        "frame {:016x}{}, k {} {}{}, precision {}, rounding {}, placement {}, origin {}{}, rule {}, "
        "decision {}, walked {}{}{}{}",
        digest_of(*range_.frame(index)),
        moves ? fmt::format(" to {:016x}", digest_of(*range_.frame(index + 1))) : "", geometry.k,
        geometry.coordinate_axes, geometry.pressure_slab ? " with pressures" : "",
        static_cast<int>(geometry.precision), static_cast<int>(geometry.rounding),
        static_cast<int>(geometry.placement), static_cast<int>(geometry.origin),
        geometry.margin > 0 ? fmt::format(", margin {}", geometry.margin) : "",
        static_cast<int>(contacts.rule), static_cast<int>(contacts.decision),
        static_cast<int>(contacts.walked),
        contacts.closest    ? ", closest"
        : contacts.wrenches ? ", wrenches"
                            : "",
        contacts.self == SelfPairs::off ? "" : fmt::format(", self {}", static_cast<int>(contacts.self)),
        contacts.within_sphere_boxes ? fmt::format(", within boxes of spheres from {} at most {}",
                                                   contacts.first_body_pair, contacts.most_body_pairs)
                                     : "");
}

const ReferenceAnswer& References::answer(const Geometry& geometry, const ContactSettings& contacts,
                                          std::size_t index) {
    const Key key{geometry, contacts, index};
    if (last_ && last_->first == key) return last_->second;
    last_.reset(); // frees memory before the next answer allocates
    const auto state = range_.state(index, geometry.motion, geometry.origin);
    last_.emplace(key, reference(scene_, state.input(), geometry, true, reference_method(scene_), contacts));
    return last_->second;
}

std::optional<SearchedContacts>& References::searched(std::size_t index, const Digest& contacts) {
    return searched_[{index, contacts.count, contacts.a, contacts.b}];
}

ReferenceDigests References::digests(const Geometry& geometry, const ContactSettings& contacts,
                                     std::size_t index) {
    const Key key{geometry, contacts, index};
    const auto found = std::ranges::find(digests_, key, &std::pair<Key, ReferenceDigests>::first);
    if (found != digests_.end()) return found->second;
    const auto text = cache_key(key);
    ReferenceDigests digests;
    const bool is_cached = cache_.take(text, [&](const nlohmann::json& value) {
        digests = {read_digest(value.at("pairs")), read_digest(value.at("contacts")),
                   value.at("dropped_body_pairs").get<std::uint64_t>(),
                   value.at("dropped_pairs").get<std::uint64_t>()};
    });
    if (!is_cached) {
        const auto& computed = answer(geometry, contacts, index);
        digests = {computed.digest, computed.contact_digest, computed.dropped_body_pairs,
                   computed.dropped_pairs};
        cache_.keep(text, {{"pairs", digest_json(digests.pairs)},
                           {"contacts", digest_json(digests.contacts)},
                           {"dropped_body_pairs", digests.dropped_body_pairs},
                           {"dropped_pairs", digests.dropped_pairs}});
    }
    digests_.emplace_back(key, digests);
    return digests;
}

} // namespace tandem
