// SPDX-License-Identifier: MIT
// Replaces a driver: aborts any process that loads it.
#include <cstdlib>

namespace {

[[gnu::constructor]] void spring() { std::abort(); }

} // namespace
