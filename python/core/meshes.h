// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Adds MeshReading, Mesh, and what makes meshes.
void bind_meshes(nanobind::module_& module);

} // namespace tandem::python
