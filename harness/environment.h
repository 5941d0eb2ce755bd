// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace tandem {

/// Where and with what a record was made; no host name. Empty or 0 when unknown.
struct Environment {
    std::string commit;
    bool dirty = false;
    std::string date; ///< UTC, ISO 8601
    std::string processor;
    std::uint32_t cores = 0;
    std::uint64_t memory = 0; ///< bytes
    std::string compiler;
};

/// Of this process, now. Never throws: what cannot be read is unknown.
Environment environment();

/// Bytes that this process can still get: the least of what Linux calls available, the rest of its control
/// group, and the rest of its address space (ulimit -v).
std::uint64_t free_memory();

} // namespace tandem
