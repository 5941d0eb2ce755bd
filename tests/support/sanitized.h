// SPDX-License-Identifier: MIT
#pragma once

namespace tandem::testing_support {

/// Whether the library here is sanitized: its host kernels are those of k = 8 and 18 only, and everything
/// takes long, so that a part of the pairs has to do.
bool sanitized();

} // namespace tandem::testing_support
