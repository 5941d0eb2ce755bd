// SPDX-License-Identifier: MIT
#pragma once

#include "python/core/collider.h"

namespace tandem::python {

/// `poses`: None or an array; `vertices`: None, a list of one array for each deformable body, or {body:
/// array}. None where vertices are something else, before any array is looked at: others have words for that.
/// Throws as given_rows does.
std::optional<Input> input_of(const Collider& collider, nanobind::handle poses, nanobind::handle vertices);

/// The same of lists with an entry for each body, by device_rows.
Input device_input(const Collider& collider, nanobind::handle poses, const nanobind::list& vertices);

} // namespace tandem::python
