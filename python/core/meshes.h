// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Adds Mesh and read_mesh().
void bind_meshes(nanobind::module_& module);

} // namespace tandem::python
