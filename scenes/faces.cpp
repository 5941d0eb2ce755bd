// SPDX-License-Identifier: MIT
#include "scenes/faces.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace tandem {

namespace {

/// Calls visit(face) for the four faces of every tetrahedron.
template<class Visit>
void for_faces_of(const Mesh& mesh, Visit visit) {
    for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto corners = joined(mesh, mesh.tetrahedra[t]);
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            Face face{{}, t, corner};
            for (std::uint32_t i = 0, n = 0; i < 4; ++i)
                if (i != corner) face.vertices[n++] = corners[i];
            std::sort(face.vertices.begin(), face.vertices.end());
            visit(face);
        }
    }
}

} // namespace

// Sorting replaces a hash table of faces. Faces are counted and placed by their first vertex, which leaves
// short lists to sort.
std::vector<Face> sorted_faces(const Mesh& mesh) {
    std::vector<std::uint64_t> ends(mesh.vertices.size() + 1);
    for_faces_of(mesh, [&](const Face& face) { ++ends[face.vertices[0] + 1]; });
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Face> faces(mesh.tetrahedra.size() * 4);
    for_faces_of(mesh, [&](const Face& face) { faces[ends[face.vertices[0]]++] = face; });
    auto first = faces.begin();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto end = faces.begin() + static_cast<std::ptrdiff_t>(ends[v]);
        std::sort(first, end, [](const Face& a, const Face& b) { return a.vertices < b.vertices; });
        first = end;
    }
    return faces;
}

} // namespace tandem
