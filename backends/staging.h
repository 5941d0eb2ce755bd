// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tandem {

/// Host memory for transfers in flight: handed out front to back, taken back all at once, used again, and
/// never more than a limit, so that a host that never waits does not fill its memory with copies.
class Staging {
public:
    /// Where the memory comes from; `allocate` gives null when there is no more.
    struct Source {
        std::function<std::byte*(std::size_t bytes)> allocate;
        std::function<void(std::byte*)> free;
    };

    /// `limit`: the most bytes that it holds.
    Staging(Source source, std::size_t limit) : source_(std::move(source)), limit_(limit) {}
    ~Staging() { drop(); }
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;

    /// `bytes` bytes that stay untouched until release(); null where the limit or the system gives no more,
    /// and the caller has to wait for its transfer instead.
    std::byte* take(std::size_t bytes);
    /// Everything handed out may be used again: no transfer is in flight.
    void release();
    /// Gives the memory back: no transfer is in flight.
    void drop();
    /// Leaves the memory to the process for good: whether transfers are in flight cannot be found out.
    void abandon() { blocks_.clear(); }

private:
    struct Block {
        std::byte* memory;
        std::size_t size;
        std::size_t used;
    };

    Source source_;
    std::size_t limit_;
    std::size_t held_ = 0; ///< the sizes of all blocks
    std::vector<Block> blocks_;
};

} // namespace tandem
