// SPDX-License-Identifier: MIT
#include "scenes/recording/bytes.h"

#include <zlib.h>

namespace tandem::recording {

std::uint32_t checksum(std::string_view bytes, std::uint32_t start) {
    return static_cast<std::uint32_t>(
        crc32_z(start, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string sealed(std::string bytes) {
    put(bytes, checksum(bytes));
    return bytes;
}

} // namespace tandem::recording
