// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/collider.h"

namespace tandem::python {

/// `poses`: None or an array; `vertices`: None, a list with one array per deformable body, or {body: array}.
/// None for another `vertices`, before any array is read: the Python caller reports the error. Throws as
/// given_rows does.
std::optional<Input> input_of(const Collider& collider, nanobind::handle poses, nanobind::handle vertices);

/// The same by device_rows; `vertices` has one entry per body.
Input device_input(const Collider& collider, nanobind::handle poses, const nanobind::list& vertices);

} // namespace tandem::python
