// SPDX-License-Identifier: MIT
// The one file of the tests that is compiled anew for the sanitized library.
#include "tests/support/sanitized.h"

namespace tandem::testing_support {

#ifdef TANDEM_SANITIZED
bool sanitized() { return true; }
#else
bool sanitized() { return false; }
#endif

} // namespace tandem::testing_support
