// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Bad use or bad input as ValueError, failures of devices as the module's DeviceError and OutOfMemory, each
/// with its sentence.
void bind_errors(nanobind::module_& module);

} // namespace tandem::python
