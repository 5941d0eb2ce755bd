// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tandem {

/// Host memory for transfers in flight. It is allotted front to back, released all at once and reused. The
/// limit prevents a host that never waits from filling its memory with copies.
class Staging {
public:
    /// The allocator; `allocate` returns null when no memory is left.
    struct Source {
        std::function<std::byte*(std::size_t bytes)> allocate;
        std::function<void(std::byte*)> free;
    };

    /// `limit`: the maximum of bytes that it holds.
    Staging(Source source, std::size_t limit) : source_(std::move(source)), limit_(limit) {}
    ~Staging() { drop(); }
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;

    /// Returns `bytes` bytes that stay valid until release(). Null when the limit or the system allows no
    /// more; the caller then waits for its transfer instead.
    std::byte* take(std::size_t bytes);
    /// Makes all memory available again. No transfer may be in flight.
    void release();
    /// Frees the memory. No transfer may be in flight.
    void drop();
    /// Leaks the memory, because transfers may still be in flight.
    void abandon() { blocks_.clear(); }

private:
    struct Block {
        std::byte* memory;
        std::size_t size;
        std::size_t used;
    };

    Source source_;
    std::size_t limit_;
    std::size_t held_ = 0; ///< sum of the sizes of all blocks
    std::vector<Block> blocks_;
};

} // namespace tandem
