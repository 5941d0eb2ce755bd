// SPDX-License-Identifier: MIT
#include "tests/cuda/allocations.h"

#include <cstdlib>
#include <new>

namespace {
thread_local std::size_t count = 0;
} // namespace

std::size_t allocations() { return count; }

void* operator new(std::size_t bytes) {
    ++count;
    if (auto* memory = std::malloc(bytes)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
