// SPDX-License-Identifier: MIT
#pragma once

#include "backends/host/dialect.h"

namespace tandem {

inline constexpr const char* native_source = "algorithms/baselines/embree/native_kernel.h";

/// Registers a compiled function as a kernel of device host, so that another library's work for a stage is a
/// launch with the same clock as all launches. Its parameters are scalars and pointers. Launches pass buffers
/// for pointers (adopted ones: any object). It runs as one group, the only one, and may start its own
/// threads. Must be called before main starts; returns true.
template<auto Function>
bool list_native(const char* entry) {
    using Call = host::Invoke<Function>;
    static const host::HostKernel row{native_source, entry, "", Call::run, Call::count, {}, 0};
    static const std::span<const host::HostKernel> variant(&row, 1);
    host::add_host_kernels({&variant, 1});
    return true;
}

inline Kernel compile_native(Device& device, std::string_view entry) {
    return device.compile({native_source, ""}, entry, {});
}

} // namespace tandem
