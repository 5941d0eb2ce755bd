// SPDX-License-Identifier: MIT
#pragma once

#include "backends/device.h"
#include "scenes/scene.h"

namespace tandem {

/// Uploads the table that may_meet of filters.clh reads. Without has_filters() it is one unused word. Throws
/// OutOfMemory.
Buffer uploaded_filters(Device& device, const Scene& scene);

} // namespace tandem
