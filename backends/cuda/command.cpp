// SPDX-License-Identifier: MIT
#include "backends/cuda/command.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::cuda {

Result Command::submit(const Driver& driver, Stream stream) const {
    switch (kind) {
    case Kind::upload:
        return driver.cuMemcpyHtoDAsync_v2(device, host, bytes, stream);
    case Kind::download:
        return driver.cuMemcpyDtoHAsync_v2(host, device, bytes, stream);
    case Kind::clear:
        return driver.cuMemsetD8Async(device, 0, bytes, stream);
    case Kind::launch:
        break;
    }
    // The driver copies the values before it returns. The last pointer is followed by null.
    std::array<void*, max_arguments + 1> pointers{};
    for (std::size_t i = 0; i < arguments; ++i) pointers[i] = const_cast<std::uint64_t*>(&values[i]);
    return driver.cuLaunchKernel(function, groups, 1, 1, group_size, 1, 1, 0, stream, pointers.data(),
                                 nullptr);
}

std::string_view Command::call() const {
    constexpr std::string_view names[] = {"cuLaunchKernel", "cuMemcpyHtoDAsync", "cuMemcpyDtoHAsync",
                                          "cuMemsetD8Async"};
    return names[static_cast<std::size_t>(kind)];
}

std::string Command::describe() const {
    if (kind == Kind::launch)
        return fmt::format("launching '{}' with {} groups of {}", label, groups, group_size);
    constexpr std::string_view verbs[] = {"launching", "uploading", "downloading", "clearing"};
    return fmt::format("{} '{}'", verbs[static_cast<std::size_t>(kind)], label);
}

bool Command::operator==(const Command& other) const {
    return kind == other.kind && function == other.function && groups == other.groups
           && group_size == other.group_size && arguments == other.arguments && device == other.device
           && host == other.host && bytes == other.bytes
           && std::equal(values.begin(), values.begin() + arguments, other.values.begin());
}

} // namespace tandem::cuda
