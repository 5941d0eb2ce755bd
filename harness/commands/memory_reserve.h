// SPDX-License-Identifier: MIT
#pragma once

namespace tandem {

/// Memory set aside for when there is no more: the first allocation that finds none takes it, so that what
/// may not fail (destructors, of JSON for one, allocate) does not, and what is under way ends in order.
/// `operator new` fails as ever once it is spent (Meyers, Effective C++, 3rd ed. 2005, item 49). One a
/// program.
class MemoryReserve {
public:
    MemoryReserve();
    ~MemoryReserve();
    MemoryReserve(const MemoryReserve&) = delete;
    MemoryReserve& operator=(const MemoryReserve&) = delete;

    /// Sets it aside again where it was spent; throws std::bad_alloc where there still is not as much. Called
    /// before work that may stop there. Nothing where no MemoryReserve lives.
    static void refill();
};

} // namespace tandem
