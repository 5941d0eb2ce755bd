// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace tandem {

/// What NVIDIA's assembler said of one entry point; -1 when it said nothing.
struct EntryUse {
    std::int64_t registers = -1;
    std::int64_t spill_bytes = -1; ///< stores and loads together
};

/// Finds `entry` in the assembler's verbose log, as NVRTC and NVIDIA's OpenCL hand it out.
EntryUse use_of(std::string_view log, std::string_view entry);

} // namespace tandem
