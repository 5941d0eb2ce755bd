// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace tandem {

/// One of `of` shards of a plan: the groups whose number modulo `of` is `index`.
struct Shard {
    std::size_t index = 0, of = 1;
};

/// Parses --shard: "I/N", or "slurm" for the shard of this task of a Slurm job array. Throws InputError.
Shard parse_shard(const std::string& text);

} // namespace tandem
