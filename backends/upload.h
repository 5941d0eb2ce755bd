// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

namespace tandem {

/// Creates a table: a buffer with the content `bytes`, which frames only read. The upload counts as
/// Stage::write. Throws OutOfMemory or DeviceError.
inline Buffer uploaded(Device& device, std::span<const std::byte> bytes, std::string_view label) {
    auto buffer = device.allocate(bytes.size(), label);
    const StageScope scope(device, Stage::write);
    device.upload(buffer, bytes);
    buffer.impl().is_table = true;
    return buffer;
}

} // namespace tandem
