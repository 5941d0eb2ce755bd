// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace tandem {

/// The processor limits of this process's control group and its ancestors.
struct ControlGroup {
    std::optional<double> cores;            ///< the smallest quota; empty without a limit
    std::optional<std::uint64_t> throttled; ///< periods so far with an exhausted quota
};

/// Reads control groups of versions 1 and 2 under `root` ("/"). Never throws: values that cannot be read stay
/// unknown.
ControlGroup read_control_group(const std::string& root);

} // namespace tandem
