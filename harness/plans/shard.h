// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace tandem {

/// One of `of` parts of a plan: the groups whose number modulo `of` is `index`.
struct Shard {
    std::size_t index = 0, of = 1;
};

/// The shard that --shard asks for: "I/N", or "slurm" for the task of a Slurm job array that this process is.
/// Throws InputError.
Shard parse_shard(const std::string& text);

} // namespace tandem
