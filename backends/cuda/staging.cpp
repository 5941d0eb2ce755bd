// SPDX-License-Identifier: MIT
#include "backends/cuda/staging.h"

#include <algorithm>

namespace tandem::cuda {

namespace {

constexpr std::size_t block_bytes = std::size_t{4} << 20;
constexpr std::size_t alignment = 256;

} // namespace

Staging::~Staging() {
    for (const auto& block : blocks_) driver_.cuMemFreeHost(block.memory);
}

std::byte* Staging::take(std::size_t bytes) {
    const auto rounded = (bytes + alignment - 1) / alignment * alignment;
    for (auto& block : blocks_) {
        if (block.size - block.used < rounded) continue;
        auto* memory = block.memory + block.used;
        block.used += rounded;
        return memory;
    }
    void* memory = nullptr;
    const auto size = std::max(rounded, block_bytes);
    if (driver_.cuMemHostAlloc(&memory, size, 0) != 0) return nullptr;
    blocks_.push_back({static_cast<std::byte*>(memory), size, rounded});
    return blocks_.back().memory;
}

void Staging::release() {
    for (auto& block : blocks_) block.used = 0;
}

} // namespace tandem::cuda
