// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/device_groups.h"

#include <string_view>

namespace tandem::python {

/// The runtimes of OpenCL and CUDA do not survive fork(): their threads are gone, and a call waits for ever.
/// Throws DeviceError in a process that was forked after its parent opened a device of such a runtime. `use`:
/// the device, for the message. Devices "host" work in both processes.
void check_process(std::string_view use);
/// Notes that this process has opened such a device, after which its children cannot.
void note_runtime();
/// Whether check_process throws, for objects that must then leave their devices alone.
bool is_forked();
/// Whether a device of the group has such a runtime.
bool has_runtime(const DeviceGroup& devices);

} // namespace tandem::python
