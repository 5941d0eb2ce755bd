// SPDX-License-Identifier: MIT
#include "algorithms/published/chunked_seeds.h"

#include "algorithms/chunked/levels.clh"

namespace tandem {

namespace {

constexpr std::uint64_t seed_words = 3;

} // namespace

std::vector<std::uint32_t> PublishedChunkedWalker::seeds_of_level(std::span<const BodyPair> body_pairs,
                                                                  std::uint32_t level) const {
    std::vector<std::uint32_t> seeds;
    for (std::uint32_t pair = 0; pair < body_pairs.size(); ++pair) {
        const auto [a, b] = body_pairs[pair];
        if (seed_level(a, b, body_pairs.size()) != level) continue;
        for (std::uint32_t i = 0; i < trees().levels(a)[level].chunks; ++i)
            for (std::uint32_t j = 0; j < trees().levels(b)[level].chunks; ++j)
                seeds.insert(seeds.end(), {pair, i, j});
    }
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
