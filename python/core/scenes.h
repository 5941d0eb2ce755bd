// SPDX-License-Identifier: MIT
#pragma once

#include <nanobind/nanobind.h>

namespace tandem::python {

/// Adds Scene and make_scene().
void bind_scenes(nanobind::module_& module);

} // namespace tandem::python
