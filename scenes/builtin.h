// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <span>
#include <string_view>

namespace tandem {

/// Names of the meshes that are part of the program (scenes/meshes), in ascending order.
std::span<const std::string> built_in_names();

/// One of them; throws InputError that names the nearest.
Mesh built_in_mesh(std::string_view name);

} // namespace tandem
