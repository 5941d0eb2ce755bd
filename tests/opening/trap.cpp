// SPDX-License-Identifier: MIT
// Stands for a driver that breaks whoever loads it.
#include <cstdlib>

namespace {

[[gnu::constructor]] void spring() { std::abort(); }

} // namespace
