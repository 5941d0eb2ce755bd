// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

/// Number of heap allocations of the calling thread; allocations.cpp replaces operator new.
std::size_t allocations();
