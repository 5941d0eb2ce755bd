// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

#include <cstddef>
#include <vector>

namespace tandem::cuda {

/// Page-locked host memory for transfers in flight: handed out front to back, taken back all at once.
class Staging {
public:
    explicit Staging(const Driver& driver) : driver_(driver) {}
    ~Staging();
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;

    /// `bytes` bytes that stay untouched until release(); null when the system gives no more such memory. The
    /// context must be current.
    std::byte* take(std::size_t bytes);
    /// Everything handed out may be used again.
    void release();

private:
    struct Block {
        std::byte* memory;
        std::size_t size;
        std::size_t used;
    };

    const Driver& driver_;
    std::vector<Block> blocks_;
};

} // namespace tandem::cuda
