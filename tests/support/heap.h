// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <malloc.h>

namespace tandem::support {

/// Bytes of heap in use; 0 under a sanitizer, which replaces the heap.
inline std::size_t heap() {
    const auto use = mallinfo2();
    return use.uordblks + use.hblkhd;
}

} // namespace tandem::support
