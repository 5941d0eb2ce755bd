// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Adds devices().
void bind_devices(nanobind::module_& module);

} // namespace tandem::python
