// SPDX-License-Identifier: MIT
#pragma once

#include "backends/host/dialect.h"

namespace tandem {

inline constexpr const char* native_source = "algorithms/baselines/embree/native_kernel.h";

/// Makes a compiled function a kernel of device host: what another library does for a stage is then a launch,
/// under the clock that all launches have. Its parameters are pointers, for which launches give buffers
/// (adopted ones: any object), and scalars. It is launched as one group and may have threads of its own,
/// since then there are no others. To be called before main begins; returns true.
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
