// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tandem {

/// A mesh of scenes/meshes as text in TetGen's format.
struct EmbeddedMesh {
    std::string name;
    std::string_view node, ele;
};

/// Every mesh of scenes/meshes (generated from the files).
std::span<const EmbeddedMesh> embedded_meshes();

} // namespace tandem
