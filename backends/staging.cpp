// SPDX-License-Identifier: MIT
#include "backends/staging.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::size_t block_bytes = std::size_t{4} << 20;
constexpr std::size_t alignment = 256;

} // namespace

std::byte* Staging::take(std::size_t bytes) {
    const auto rounded = (bytes + alignment - 1) / alignment * alignment;
    const auto size = std::max(rounded, std::min(block_bytes, limit_));
    if (size > limit_) return nullptr;
    for (auto& block : blocks_) {
        if (block.size - block.used < rounded) continue;
        auto* memory = block.memory + block.used;
        block.used += rounded;
        return memory;
    }
    if (size > limit_ - held_) {
        const bool idle =
            std::all_of(blocks_.begin(), blocks_.end(), [](const auto& block) { return block.used == 0; });
        if (!idle) return nullptr;
        drop(); // blocks that are too small would fill the limit for ever
    }
    auto* memory = source_.allocate(size);
    if (memory == nullptr) return nullptr;
    blocks_.push_back({memory, size, rounded});
    held_ += size;
    return memory;
}

void Staging::release() {
    for (auto& block : blocks_) block.used = 0;
}

void Staging::drop() {
    for (const auto& block : blocks_) source_.free(block.memory);
    blocks_.clear();
    held_ = 0;
}

} // namespace tandem
