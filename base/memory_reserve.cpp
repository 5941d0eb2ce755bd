// SPDX-License-Identifier: MIT
#include "base/memory_reserve.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace tandem {

namespace {

constexpr std::size_t reserved_bytes = std::size_t{4}
                                       << 20; ///< more than it takes to make and write a record
std::atomic<void*> reserved{nullptr};
std::atomic<bool> reserve_is_active{false}; ///< true while a MemoryReserve exists

/// The new-handler: operator new tries again when it returns.
void spend_reserve() {
    auto* const block = reserved.exchange(nullptr);
    if (block == nullptr) throw std::bad_alloc();
    std::free(block);
}

} // namespace

MemoryReserve::MemoryReserve() {
    reserve_is_active = true;
    refill();
    std::set_new_handler(spend_reserve);
}

MemoryReserve::~MemoryReserve() {
    reserve_is_active = false;
    std::set_new_handler(nullptr);
    std::free(reserved.exchange(nullptr));
}

void MemoryReserve::refill() {
    if (!reserve_is_active || reserved.load() != nullptr) return;
    auto* const block = std::malloc(reserved_bytes);
    if (block == nullptr) throw std::bad_alloc();
    void* none = nullptr;
    if (!reserved.compare_exchange_strong(none, block)) std::free(block);
}

} // namespace tandem
