// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tandem {

/// What this process's control groups, it and those above it, leave it of the processor.
struct ControlGroup {
    std::optional<double> cores;            ///< the least quota; none where there is no limit
    std::optional<std::uint64_t> throttled; ///< periods so far in which a quota was used up
};

/// Of versions 2 and 1, with files under `root` ("/"). Never throws: what cannot be read is unknown.
ControlGroup read_control_group(const std::string& root);

} // namespace tandem
