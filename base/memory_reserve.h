// SPDX-License-Identifier: MIT
#pragma once

namespace tandem {

/// Memory set aside for the case that no more is available. The first allocation that fails frees the reserve
/// and tries again, so that work in progress can end in order: JSON destructors, for example, allocate. Once
/// the reserve is spent, `operator new` fails as usual (Meyers, Effective C++, 3rd ed. 2005, item 49). A
/// program has one instance.
class MemoryReserve {
public:
    MemoryReserve();
    ~MemoryReserve();
    MemoryReserve(const MemoryReserve&) = delete;
    MemoryReserve& operator=(const MemoryReserve&) = delete;

    /// Allocates the reserve again if it was spent; throws std::bad_alloc when memory is still short. Call it
    /// where the work can be stopped safely. Does nothing while no MemoryReserve exists.
    static void refill();
};

} // namespace tandem
