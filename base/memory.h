// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace tandem {

/// Bytes that this process can still allocate: the minimum of Linux's available memory, the rest of its
/// control group, and the rest of its address space (ulimit -v).
std::uint64_t free_memory();

/// Throws InputError when `what` ("3 bodies of mesh jack") needs at least `bytes` bytes and fewer are free.
/// Call it before any allocation.
void refuse_beyond_memory(std::string_view what, double bytes);

} // namespace tandem
