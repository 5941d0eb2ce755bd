// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Translates InputError to ValueError, and DeviceError and OutOfMemory to the module's exceptions of these
/// names. Messages are kept.
void bind_errors(nanobind::module_& module);

} // namespace tandem::python
