// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tandem {

/// Tetrahedra per chunk, L of equations (1)-(3): two hierarchies of nodes of 4k + 24 bytes fit in `bytes`.
/// Equation (2) uses the lower power of two, as the paper's own chunk counts require. At least 2.
std::uint32_t leaves_of_chunk_bytes(std::uint64_t bytes, int k);

/// One level: its first node slot relative to the body's first, its number of items and its number of chunks.
struct Level {
    std::uint32_t slot = 0;
    std::uint32_t items = 0;
    std::uint32_t chunks = 0;
};

/// Levels of a body (Algorithm 1). Level 0 covers the tetrahedra, each higher level the chunk roots of the
/// one below, until at most `leaves` chunks are left. A level of n items has 2n slots.
std::vector<Level> chunk_levels(std::uint32_t tetrahedra, std::uint32_t leaves);

std::uint32_t slot_count(std::span<const Level> levels);

/// The smallest e with 2^e >= n; n >= 1.
std::uint32_t ceil_log2(std::uint32_t n);

} // namespace tandem
