// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/frames.h"
#include "harness/verify/verification_cache.h"
#include "harness/verify/reference.h"

#include <optional>

namespace tandem {

/// Digests of the reference's answer to one frame.
struct ReferenceDigests {
    Digest pairs, contacts;
};

/// Answers of the reference per frame, computed once for each geometry: digests, which are kept from one run
/// of the program to the next, and pairs where an answer is another.
class References {
public:
    /// Both must outlive this; an empty folder keeps nothing.
    References(const Scene& scene, const FrameRange& range, const std::filesystem::path& folder = {});

    /// Of frame number `index` of the range; serial host code that may take minutes on a large scene.
    ReferenceDigests digests(const Geometry& geometry, const ContactSettings& contacts, std::size_t index);
    /// The whole answer, computed by this process whatever was kept; of the frame that was asked for last it
    /// is still there.
    const ReferenceAnswer& answer(const Geometry& geometry, const ContactSettings& contacts,
                                  std::size_t index);

private:
    using Key = std::tuple<Geometry, ContactSettings, std::size_t>;
    std::string question(const Key& key) const;

    const Scene& scene_;
    const FrameRange& range_;
    VerificationCache kept_;
    std::vector<std::pair<Key, ReferenceDigests>> known_;
    std::optional<std::pair<Key, ReferenceAnswer>> last_;
};

} // namespace tandem
