// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace tandem {

/// Resources of one entry point as NVIDIA's assembler reports them; -1 when it does not.
struct EntryUse {
    std::int64_t registers = -1;
    std::int64_t spill_bytes = -1; ///< stores and loads together
    std::int64_t stack_bytes = -1; ///< stack frame of a work-item, in device memory
};

/// Finds `entry` in the assembler's verbose log, which NVRTC and NVIDIA's OpenCL return.
EntryUse use_of(std::string_view log, std::string_view entry);

} // namespace tandem
