// SPDX-License-Identifier: MIT
#include "algorithms/chunked/published_seeds.h"

#include "algorithms/chunked/levels.clh"

namespace tandem {

namespace {

constexpr std::uint64_t seed_words = 3;

} // namespace

/// Calls visit(pair, chunks of a, chunks of b) for each body pair of the level.
template<class Visit>
void PublishedChunkedWalker::each_of_level(std::span<const BodyPair> body_pairs, std::uint32_t level,
                                           Visit visit) const {
    for (std::uint32_t pair = 0; pair < body_pairs.size(); ++pair) {
        const auto [a, b] = body_pairs[pair];
        if (seed_level(a, b, body_pairs.size()) == level)
            visit(pair, trees().levels(a)[level].chunks, trees().levels(b)[level].chunks);
    }
}

/// Counts first, because a list that grows would copy the seeds several times.
std::vector<std::uint32_t> PublishedChunkedWalker::seeds_of_level(std::span<const BodyPair> body_pairs,
                                                                  std::uint32_t level) const {
    std::uint64_t count = 0;
    each_of_level(body_pairs, level, [&](std::uint32_t, std::uint32_t chunks_a, std::uint32_t chunks_b) {
        count += std::uint64_t{chunks_a} * chunks_b;
    });
    std::vector<std::uint32_t> seeds(count * seed_words);
    auto* next = seeds.data();
    each_of_level(body_pairs, level, [&](std::uint32_t pair, std::uint32_t chunks_a, std::uint32_t chunks_b) {
        for (std::uint32_t i = 0; i < chunks_a; ++i)
            for (std::uint32_t j = 0; j < chunks_b; ++j) {
                *next++ = pair;
                *next++ = i;
                *next++ = j;
            }
    });
    return seeds;
}

void PublishedChunkedWalker::do_launch(const WalkTask& task) {
    wanted_ = 0;
    {
        const StageScope scope(device(), Stage::write);
        device().clear(starts().buffer(), starts().buffer().bytes()); // the device makes no seeds
    }
    // From the top: walks of a level may hand seeds down to the next one, which appends its own seeds.
    std::uint64_t from_above = 0;
    for (std::uint32_t level = top_level() + 1; level-- > 0;) {
        std::vector<std::uint32_t> seeds;
        {
            const HostWork work(device(), Stage::preprocess, "make seeds");
            seeds = seeds_of_level(task.on_host, level);
        }
        const auto total = from_above + seeds.size() / seed_words;
        if (total > handed_capacity()) {
            wanted_ = total;
            return;
        }
        {
            const StageScope scope(device(), Stage::write);
            device().upload(handed(level), bytes_of(seeds), from_above * seed_words * 4, true);
        }
        task.status.set(STATUS_LEVELS + 2 * level, total);
        traverse(task, level, 0);
        if (task.launch_hook != nullptr) task.launch_hook->part_walked();
        if (level == 0) return;
        task.status.read();
        from_above = task.status.counter(STATUS_LEVELS + 2 * (level - 1));
    }
}

bool PublishedChunkedWalker::do_grow(const Status&) {
    if (wanted_ == 0) return false;
    grow_handed(wanted_);
    return true;
}

} // namespace tandem
