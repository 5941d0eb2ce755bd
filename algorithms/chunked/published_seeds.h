// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/chunked/chunked_walker.h"

namespace tandem {

/// The chunked walk with the paper's schedule. The host makes and uploads seeds, writes counters before every
/// launch and reads them afterwards. Contacts follow every launch that found pairs.
class PublishedChunkedWalker final : public ChunkedWalker {
public:
    using ChunkedWalker::ChunkedWalker;

private:
    void do_launch(const WalkTask& task) override;
    bool do_grow(const Status& status) override;
    std::optional<std::vector<Limit>> do_limits() const override { return std::nullopt; }

    template<class Visit>
    void each_of_level(std::span<const BodyPair> pairs, std::uint32_t level, Visit visit) const;
    std::vector<std::uint32_t> seeds_of_level(std::span<const BodyPair> pairs, std::uint32_t level) const;

    std::uint64_t wanted_ = 0; ///< seeds that exceeded the capacity of the last launch; 0: none
};

} // namespace tandem
