// SPDX-License-Identifier: MIT
#include "scenes/faces.h"

#include <algorithm>

namespace tandem {

// Sorting replaces a hash table of faces.
std::vector<Face> sorted_faces(const Mesh& mesh) {
    std::vector<Face> faces;
    faces.reserve(mesh.tetrahedra.size() * 4);
    for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto corners = joined(mesh, mesh.tetrahedra[t]);
        for (std::uint32_t corner = 0; corner < 4; ++corner) {
            Face face{{}, t, corner};
            for (std::uint32_t i = 0, n = 0; i < 4; ++i)
                if (i != corner) face.vertices[n++] = corners[i];
            std::sort(face.vertices.begin(), face.vertices.end());
            faces.push_back(face);
        }
    }
    std::sort(faces.begin(), faces.end(),
              [](const Face& a, const Face& b) { return a.vertices < b.vertices; });
    return faces;
}

} // namespace tandem
