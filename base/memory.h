// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace tandem {

/// Bytes that this process can still get: the least of what Linux calls available, the rest of its control
/// group, and the rest of its address space (ulimit -v).
std::uint64_t free_memory();

/// Throws InputError, before anything is made, where `what` ("3 bodies of mesh jack") takes at least so many
/// bytes and fewer are free.
void refuse_beyond_memory(std::string_view what, double bytes);

} // namespace tandem
