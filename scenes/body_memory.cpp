// SPDX-License-Identifier: MIT
#include "scenes/body_memory.h"

#include <fmt/format.h>

namespace tandem {

void refuse_bodies_beyond_memory(std::uint64_t bodies, const Mesh& mesh, std::uint64_t levels) {
    // A refinement adds at least one vertex a tetrahedron.
    double vertices = static_cast<double>(mesh.vertices.size()),
           tetrahedra = static_cast<double>(mesh.tetrahedra.size());
    for (std::uint64_t level = 0; level < levels; ++level, tetrahedra *= 8) vertices += tetrahedra;
    refuse_beyond_memory(fmt::format("{} bodies of mesh {}{}", bodies, mesh.name,
                                     levels == 0 ? "" : fmt::format(" refined {} times", levels)),
                         static_cast<double>(bodies) * vertices * 3 * sizeof(float));
}

} // namespace tandem
