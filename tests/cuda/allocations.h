// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

/// How often the calling thread has asked the heap for memory: allocations.cpp stands before operator new.
std::size_t allocations();
