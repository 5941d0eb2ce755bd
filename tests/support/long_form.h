// SPDX-License-Identifier: MIT
#pragma once

#include <cstdlib>

namespace tandem::testing_support {

/// Whether every case is wanted, as the tests of label full say by TANDEM_LONG_FORM=1; otherwise tests of
/// many settings take a share of them, in which each value is still there.
inline bool long_form() { return std::getenv("TANDEM_LONG_FORM") != nullptr; }

} // namespace tandem::testing_support
