// SPDX-License-Identifier: MIT
#include "backends/cuda/call_error.h"

#include <fmt/format.h>

namespace tandem::cuda {

void throw_call_error(const Libraries& libraries, const DeviceInfo& info, Result result,
                      std::string_view call, std::string_view what) {
    const auto text =
        fmt::format("{} ({}): {} failed with {} while {}; driver for CUDA {}, NVRTC {}", info.id, info.name,
                    call, libraries.driver.describe(result), what, version_text(libraries.driver.version),
                    version_text(libraries.nvrtc.version()));
    if (result == out_of_memory) throw OutOfMemory(text);
    throw DeviceError(text);
}

} // namespace tandem::cuda
