// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <span>

namespace tandem {

/// Every kernel file of the project, flattened and embedded (generated).
std::span<const KernelSource> kernel_sources();

/// Adds kernel files of a program's own to those that kernel_source() knows; cmake/kernels.cmake generates
/// the call. They must live as long as the program. Not thread-safe.
void add_kernel_sources(std::span<const KernelSource> sources);

/// The kernel file of that name, as in "algorithms/chunked/chunked.cl".
const KernelSource& kernel_source(std::string_view name);

/// Of the texts of all of them: what was measured with kernels of another digest says nothing of these.
std::uint64_t kernel_sources_digest();

} // namespace tandem
