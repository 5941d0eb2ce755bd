// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>

namespace tandem::support {

/// Whether to run every case: tests of label full set TANDEM_LONG_FORM=1. Otherwise tests over many settings
/// run a fraction of the cases, which still covers each value.
inline bool long_form() { return std::getenv("TANDEM_LONG_FORM") != nullptr; }

} // namespace tandem::support
