// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// What tells this machine from others while it runs: the kernel's own name for this start of it, which
/// containers on one machine share as they do its devices; else the host's name. Compared, never recorded.
std::string this_machine();

} // namespace tandem
