// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/chunked/chunked_walker.h"

namespace tandem {

/// The chunked walk by the paper's schedule: seeds made and uploaded by the host, counters written before and
/// read after every launch, contacts after every launch that found pairs (tvcg18.md 1.2 and 3).
class PublishedChunkedWalker final : public ChunkedWalker {
public:
    using ChunkedWalker::ChunkedWalker;

private:
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;

    std::vector<std::uint32_t> seeds_of_level(std::span<const BodyPair> pairs, std::uint32_t level) const;

    std::uint64_t wanted_ = 0; ///< seeds that a launch had no room for
};

} // namespace tandem
