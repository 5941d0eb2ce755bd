// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"

#include <span>

namespace tandem {

/// All kernel files of the project, flattened and embedded. The definition is generated.
std::span<const KernelSource> kernel_sources();

/// Adds kernel files of an application to those of kernel_source(); cmake/kernels.cmake generates the call.
/// They must live as long as the program. Not thread-safe.
void add_kernel_sources(std::span<const KernelSource> sources);

/// The kernel file of that name, such as "algorithms/chunked/chunked.cl". Throws DeviceError if it is
/// unknown.
const KernelSource& kernel_source(std::string_view name);

/// Compiles the kernel of which `Arguments` are the arguments into `kernel`. Throws as Device::compile().
template<class Arguments>
void compile_kernel(Device& device, KernelOf<Arguments>& kernel, const Defines& defines) {
    kernel = KernelOf<Arguments>(device.compile(kernel_source(Arguments::source), Arguments::entry, defines));
}

/// Digest of the texts of all kernel files. Measurements with another digest do not apply to these kernels.
std::uint64_t kernel_sources_digest();

} // namespace tandem
