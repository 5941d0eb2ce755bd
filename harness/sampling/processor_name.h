// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// As the kernel tells it; empty when it does not.
std::string processor_name();

} // namespace tandem
