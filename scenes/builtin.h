// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <span>
#include <string_view>

namespace tandem {

/// Names of the meshes embedded in the program (scenes/meshes), in ascending order.
std::span<const std::string> built_in_names();

/// The embedded mesh of that name. Throws InputError with the nearest name when there is none.
Mesh built_in_mesh(std::string_view name);

} // namespace tandem
