// SPDX-License-Identifier: MIT
#pragma once

#include "harness/frames/frames.h"
#include "harness/verify/deep_contact.h"
#include "harness/verify/verification_cache.h"
#include "harness/verify/reference.h"

#include <array>
#include <map>
#include <optional>

namespace tandem {

/// Digests of the reference's answer to one frame.
struct ReferenceDigests {
    Digest pairs, contacts;
    std::uint64_t dropped_body_pairs = 0, dropped_pairs = 0; ///< as in ReferenceAnswer
};

/// Answers of the reference by frame, computed once for each geometry and contact settings. Digests are
/// stored between runs of the program; pairs are computed only for a wrong answer.
class References {
public:
    /// `scene` and `range` must outlive this object. With an empty folder nothing is stored.
    References(const Scene& scene, const FrameRange& range, const std::filesystem::path& folder = {});

    /// Digests for frame number `index` of the range. Host code, which can run for minutes on a large scene.
    ReferenceDigests digests(const Geometry& geometry, const ContactSettings& contacts, std::size_t index);
    /// The whole answer, always computed by this process. The reference is valid until the next call; the
    /// last answer is cached.
    const ReferenceAnswer& answer(const Geometry& geometry, const ContactSettings& contacts,
                                  std::size_t index);

    /// Where the deep contact of an answer's contacts to that frame is kept; empty until the caller has
    /// searched them. Equal answers of several cells are then searched once.
    std::optional<SearchedContacts>& searched(std::size_t index, const Digest& contacts);

private:
    using Key = std::tuple<Geometry, ContactSettings, std::size_t>;
    std::string cache_key(const Key& key) const;

    const Scene& scene_;
    const FrameRange& range_;
    VerificationCache cache_;
    std::vector<std::pair<Key, ReferenceDigests>> digests_;
    std::optional<std::pair<Key, ReferenceAnswer>> last_;
    std::map<std::array<std::uint64_t, 4>, std::optional<SearchedContacts>> searched_; ///< by frame, digest
};

} // namespace tandem
