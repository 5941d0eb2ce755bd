// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// The processor's model name in /proc/cpuinfo; empty when unknown.
std::string processor_name();

} // namespace tandem
