// SPDX-License-Identifier: MIT
#include "scenes/mesh.h"

#include "base/error.h"
#include "scenes/faces.h"
#include "scenes/pressure_field.h"
#include "scenes/weld.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <span>
#include <utility>

namespace tandem {

namespace {

/// Six times the signed volume, in a fixed order of operations.
double determinant(const Mesh& mesh, const Tetrahedron& t) {
    const Eigen::Vector3d a = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Eigen::Vector3d b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const Eigen::Vector3d c = mesh.vertices[t[3]] - mesh.vertices[t[0]];
    return (a.x() * (b.y() * c.z() - b.z() * c.y()) - a.y() * (b.x() * c.z() - b.z() * c.x()))
           + a.z() * (b.x() * c.y() - b.y() * c.x());
}

/// A tetrahedron, and the first one with the same vertices.
struct Duplicate {
    std::uint32_t tetrahedron, first;
};

/// Calls visit(copies) for every face, with its copies in all tetrahedra.
template<class Visit>
void for_faces(std::span<const Face> sorted, Visit visit) {
    while (!sorted.empty()) {
        const auto end = std::ranges::find_if(
            sorted, [&](const Face& face) { return face.vertices != sorted.front().vertices; });
        const auto copies = sorted.first(static_cast<std::size_t>(end - sorted.begin()));
        visit(copies);
        sorted = sorted.subspan(copies.size());
    }
}

/// Duplicates share all faces. Each is found at the one that is opposite its largest vertex.
std::vector<Duplicate> duplicates_of(const Mesh& mesh, std::span<const Face> faces) {
    std::vector<Duplicate> found;
    std::vector<std::array<std::uint32_t, 2>> same; // opposite vertex, tetrahedron
    for_faces(faces, [&](std::span<const Face> copies) {
        if (copies.size() < 2) return;
        same.clear();
        for (const auto& face : copies) {
            const auto opposite = joined(mesh, mesh.tetrahedra[face.tetrahedron][face.corner]);
            if (opposite >= face.vertices[2]) same.push_back({opposite, face.tetrahedron});
        }
        std::ranges::sort(same);
        // A tetrahedron that has its largest vertex twice. No std::ranges::unique: clang 14 does not compile
        // the one of g++ 12.
        same.erase(std::unique(same.begin(), same.end()), same.end());
        for (std::size_t i = 1, first = 0; i < same.size(); ++i) {
            if (same[i][0] != same[first][0]) first = i;
            if (i != first) found.push_back({same[i][1], same[first][1]});
        }
    });
    std::ranges::sort(found, {}, &Duplicate::tetrahedron);
    return found;
}

/// Copies the boundary faces of a tetrahedron to its duplicate, whose corners may be in another order.
void copy_boundary(Mesh& mesh, const Duplicate& duplicate) {
    const auto from = joined(mesh, mesh.tetrahedra[duplicate.first]);
    const auto to = joined(mesh, mesh.tetrahedra[duplicate.tetrahedron]);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto corner = std::ranges::find(from, to[i]) - from.begin();
        if ((mesh.boundary[duplicate.first] >> corner & 1) != 0)
            mesh.boundary[duplicate.tetrahedron] |= static_cast<std::uint8_t>(1u << i);
    }
}

/// A face of only one tetrahedron is on the boundary; duplicates do not count.
void flag_boundary(Mesh& mesh, std::span<const Face> faces, std::span<const Duplicate> duplicates) {
    std::vector<bool> counts(mesh.tetrahedra.size(), true);
    for (const auto& duplicate : duplicates) counts[duplicate.tetrahedron] = false;
    mesh.boundary.assign(mesh.tetrahedra.size(), 0);
    for_faces(faces, [&](std::span<const Face> copies) {
        const auto is_counted = [&](const Face& face) { return counts[face.tetrahedron]; };
        if (std::ranges::count_if(copies, is_counted) != 1) return;
        const auto& face = *std::ranges::find_if(copies, is_counted);
        mesh.boundary[face.tetrahedron] |= static_cast<std::uint8_t>(1u << face.corner);
    });
}

/// Fills welded, merged and boundary.
void connect(Mesh& mesh, const std::string& source, const MeshReading& reading) {
    mesh.welded.clear();
    mesh.merged.clear();
    mesh.findings.welded = 0;
    if (reading.weld) {
        mesh.welded = welded_vertices(mesh.vertices, checked_weld(*reading.weld));
        for (std::uint32_t v = 0; v < mesh.welded.size(); ++v)
            mesh.findings.welded += mesh.welded[v] == v ? 0 : 1;
        if (mesh.findings.welded == 0) mesh.welded.clear();
    }
    const auto faces = sorted_faces(mesh);
    const auto duplicates = duplicates_of(mesh, faces);
    mesh.findings.duplicates = duplicates.size();
    if (reading.duplicates == Duplicates::reject && !duplicates.empty())
        throw InputError(fmt::format(
            "{}: {} of {} tetrahedra have the vertices of an earlier one, such as {} those of {}; "
            "repair the mesh, or choose merge or keep for duplicates",
            source, duplicates.size(), mesh.tetrahedra.size(), duplicates[0].tetrahedron,
            duplicates[0].first));
    flag_boundary(mesh, faces, duplicates);
    for (const auto& duplicate : duplicates)
        if (reading.duplicates == Duplicates::merge)
            mesh.merged.push_back(duplicate.tetrahedron);
        else
            copy_boundary(mesh, duplicate);
}

/// The error for a tetrahedron with a vertex that the mesh does not have. Ids of 1 to n are taken for those
/// of a program that counts from 1.
[[noreturn]] void refuse_vertex(const Mesh& mesh, const std::string& source, std::size_t tetrahedron,
                                std::uint32_t vertex) {
    const auto last = mesh.vertices.size();
    const bool from_one = std::ranges::all_of(mesh.tetrahedra, [&](const Tetrahedron& ids) {
        return std::ranges::all_of(ids, [&](std::uint32_t id) { return id >= 1 && id <= last; });
    });
    throw InputError(fmt::format(
        "{}: tetrahedron {} names vertex {} of {}, numbered from 0; {}", source, tetrahedron, vertex, last,
        from_one ? "all ids seem to start at 1: subtract 1 from each" : "repair the mesh"));
}

} // namespace

Tetrahedron joined(const Mesh& mesh, const Tetrahedron& tetrahedron) {
    Tetrahedron result = tetrahedron;
    for (auto& vertex : result) vertex = joined(mesh, vertex);
    return result;
}

bool is_merged(const Mesh& mesh, std::uint32_t tetrahedron) {
    return std::ranges::binary_search(mesh.merged, tetrahedron);
}

void complete_mesh(Mesh& mesh, const std::string& source, const MeshReading& reading) {
    if (mesh.tetrahedra.empty())
        throw InputError(fmt::format("{}: no tetrahedra; give a volume mesh", source));
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!mesh.vertices[v].allFinite())
            throw InputError(fmt::format("{}: vertex {} is not finite; repair the mesh", source, v));
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (const auto vertex : mesh.tetrahedra[t])
            if (vertex >= mesh.vertices.size()) refuse_vertex(mesh, source, t, vertex);
    if (reading.pressure) checked_pressure(*reading.pressure);
    const auto wanted = reading; // it may be the mesh's own
    // An earlier call made the field, maybe for another boundary.
    if (std::exchange(mesh.reading.pressure, std::nullopt)) mesh.pressures.clear();
    check_pressures(mesh, source);
    count_flawed(mesh);
    connect(mesh, source, wanted);
    mesh.reading = wanted;
    if (wanted.pressure && mesh.pressures.empty())
        make_pressures(mesh, *wanted.pressure);
    else
        mesh.reading.pressure.reset();
}

std::string findings_text(const Mesh& mesh, std::string_view weld) {
    const auto& found = mesh.findings;
    std::vector<std::string> parts;
    const auto add = [&](std::size_t count, std::string_view text) {
        if (count > 0) parts.push_back(fmt::format("{} {}", count, text));
    };
    add(found.duplicates, mesh.merged.empty()
                              ? "tetrahedra have the vertices of an earlier one and are kept"
                              : "tetrahedra have the vertices of an earlier one and take no part");
    if (mesh.welded.empty())
        add(found.coincident, fmt::format("vertices lie where an earlier one lies ({} joins them)", weld));
    add(found.welded, "vertices are welded to an earlier one");
    add(found.ghosts, "ghost cells are left out");
    add(found.reduced, "tetrahedra of higher order are read by their corners");
    add(found.other_cells, "volume cells that are not tetrahedra are left out");
    if (const double most = most_pressure_on_boundary(mesh); most > 0)
        parts.push_back(fmt::format("the pressure is not 0 on the whole boundary, but up to {}", most));
    if (mesh.reading.pressure && std::ranges::all_of(mesh.pressures, [](double p) { return p == 0; }))
        parts.emplace_back("no vertex lies inside, so that the pressure is 0 everywhere; refine the mesh");
    return fmt::format("{}", fmt::join(parts, "; "));
}

void count_flawed(Mesh& mesh) {
    mesh.inverted = mesh.degenerate = 0;
    for (const auto& t : mesh.tetrahedra) {
        const double det = determinant(mesh, t);
        mesh.inverted += det < 0 ? 1 : 0;
        mesh.degenerate += det == 0 ? 1 : 0;
    }
}

double volume(const Mesh& mesh) {
    double sum = 0;
    for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!is_merged(mesh, t)) sum += std::abs(determinant(mesh, mesh.tetrahedra[t]));
    return sum / 6;
}

} // namespace tandem
