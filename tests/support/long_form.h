// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/test.h"

namespace tandem::support {

/// Whether to run every case: tests of label full set TANDEM_LONG_FORM=1. Otherwise tests over many settings
/// run a fraction of the cases, which still covers each value.
inline bool long_form() { return std::getenv("TANDEM_LONG_FORM") != nullptr; }

} // namespace tandem::support

/// Ends a test of the short form on a device other than the host, for which kernels would compile too long.
#define TANDEM_LONG_FORM_ONLY(device)                                                                        \
    if (std::string_view(device) != "host" && !tandem::support::long_form())                                 \
    GTEST_SKIP() << "long form "                                                                             \
                    "only"
