// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/bodies/bodies.h"
#include "harness/verify/oracle/world.h"

namespace tandem::python {

/// Corners of all tetrahedra as kernels of the last frame had them: the rows of vertices and poses on the
/// device, downloaded, and moved as body.clh moves them. Waits. Throws DeviceError.
oracle::World world_on_device(const Bodies& bodies);

} // namespace tandem::python
