// SPDX-License-Identifier: MIT
#pragma once

namespace tandem::testing_support {

/// Whether everything here is sanitized: the library's host kernels are those of k = 8 and 18 only, and
/// everything takes long, so that a part of the pairs has to do.
constexpr bool sanitized() {
#ifdef TANDEM_SANITIZED
    return true;
#else
    return false;
#endif
}

} // namespace tandem::testing_support
