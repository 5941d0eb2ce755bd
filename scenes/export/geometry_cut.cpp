// SPDX-License-Identifier: MIT
#include "scenes/export/geometry_cut.h"

#include <algorithm>

namespace tandem::exporting {

namespace {

constexpr std::size_t box_vertices = 8, box_triangles = 12;
constexpr std::size_t pose_bytes = 14;    ///< seven numbers of 16 bits
constexpr std::size_t vertex_bytes = 6;   ///< three numbers of 16 bits
constexpr std::size_t contact_bytes = 11; ///< a vertex, a normal of three bytes, a depth of two

/// Sizes of all meshes after some are replaced by boxes.
struct Costs {
    std::size_t bytes = 0, triangles = 0, drawn = 0;
    std::size_t deformed = 0; ///< bytes of deformable bodies in a frame
};

std::size_t vertices_of(const GeometrySizes::MeshSizes& mesh, bool boxed) {
    return boxed ? box_vertices : mesh.vertices;
}

Costs costs_of(const GeometrySizes& sizes, const std::vector<bool>& boxed) {
    Costs costs;
    for (std::size_t i = 0; i < sizes.meshes.size(); ++i) {
        const auto& mesh = sizes.meshes[i];
        const auto triangles = boxed[i] ? box_triangles : mesh.triangles;
        costs.bytes += mesh_bytes(vertices_of(mesh, boxed[i]), triangles);
        costs.triangles += triangles;
        costs.drawn += triangles * mesh.bodies;
        costs.deformed += vertices_of(mesh, boxed[i]) * vertex_bytes * mesh.deformable;
    }
    return costs;
}

/// The mesh with most triangles that is not a box; with `of_all_bodies`, summed over its bodies. Returns the
/// number of meshes when there is none.
std::size_t largest(const GeometrySizes& sizes, const std::vector<bool>& boxed, bool of_all_bodies) {
    std::size_t found = sizes.meshes.size();
    std::size_t most = 0;
    for (std::size_t i = 0; i < sizes.meshes.size(); ++i) {
        const auto size = sizes.meshes[i].triangles * (of_all_bodies ? sizes.meshes[i].bodies : 1);
        if (boxed[i] || sizes.meshes[i].triangles <= box_triangles || size <= most) continue;
        most = size;
        found = i;
    }
    return found;
}

} // namespace

std::size_t mesh_bytes(std::size_t vertices, std::size_t triangles) {
    const std::size_t index_bytes = vertices <= 65536 ? 2 : 4;
    return vertices * vertex_bytes + triangles * (3 * index_bytes + 1);
}

GeometryCut cut(const GeometrySizes& sizes, const GeometryBudget& budget) {
    GeometryCut result{.boxed = std::vector<bool>(sizes.meshes.size(), false)};
    auto costs = costs_of(sizes, result.boxed);
    const auto half = budget.bytes / 2;
    while (costs.bytes > half || costs.triangles > budget.triangles || costs.drawn > budget.drawn
           || costs.deformed > budget.bytes / 4) {
        const bool of_all = costs.drawn > budget.drawn || costs.deformed > budget.bytes / 4;
        const auto next = largest(sizes, result.boxed, of_all);
        if (next == sizes.meshes.size()) break;
        result.boxed[next] = true;
        costs = costs_of(sizes, result.boxed);
    }
    const auto deformed_a_body = sizes.bodies > 0 ? costs.deformed / sizes.bodies : 0;
    result.bodies = std::min(sizes.bodies, budget.bytes / 4 / (pose_bytes + deformed_a_body));
    const auto body_bytes = result.bodies * (pose_bytes + deformed_a_body);
    const auto for_contacts = sizes.contacts ? budget.bytes / 5 : 0;
    const auto left = budget.bytes - std::min(std::min(costs.bytes, half) + for_contacts, budget.bytes);
    result.frames = std::clamp<std::size_t>(left / std::max<std::size_t>(body_bytes + sizes.surface_bytes, 1),
                                            1, std::max<std::size_t>(sizes.frames, 1));
    result.surface_bytes = left / result.frames - std::min(body_bytes, left / result.frames);
    result.contacts = std::min(for_contacts / result.frames / contact_bytes, budget.contacts);
    return result;
}

} // namespace tandem::exporting
