// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Identifies this machine: the kernel's boot identifier, which containers on one machine share, or else the
/// host name. Only for comparisons between ranks; never recorded.
std::string this_machine();

} // namespace tandem
