// SPDX-License-Identifier: MIT
#pragma once

namespace tandem::support {

/// Whether the build is sanitized. The library then contains host kernels for k = 8 and 18 only, and
/// everything is slow, so tests use a subset of the pairs.
constexpr bool sanitized() {
#ifdef TANDEM_SANITIZED
    return true;
#else
    return false;
#endif
}

} // namespace tandem::support
