// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"
#include "scenes/read/cursor.h"
#include "scenes/read/formats.h"
#include "scenes/read/scanner.h"
#include "scenes/read/vertex.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

/// Common parts of VTK's legacy and XML formats.
namespace tandem::read {

/// The type of the numbers in an array. Text encodings ignore it.
enum class Number { f32, f64, i8, u8, i16, u16, i32, u32, i64, u64 };

/// Whether two words are equal but for the case of their letters, as VTK compares keywords.
bool same_word(std::string_view a, std::string_view b);

/// The type by its name in either format: float, Float32, vtktypeint64, ...
std::optional<Number> number_type(std::string_view name);
std::size_t size_of(Number type);

double get_real(Scanner& in, Number type, std::string_view what);
double get_real(Cursor& in, Number type, std::string_view what);
std::int64_t get_whole(Scanner& in, Number type, std::string_view what);
std::int64_t get_whole(Cursor& in, Number type, std::string_view what);

/// All cells of a file. Cell i has the vertices from ends[i-1] (or 0) to ends[i].
struct VtkCells {
    std::vector<std::uint32_t> vertices;
    std::vector<std::uint64_t> ends;
    std::vector<std::uint8_t> ghosts = {}; ///< bits of vtkGhostType, one row a cell; empty: none
};

/// The name of a volume cell, or "unknown". Returns "" for a cell of lower dimension, which is skipped.
std::string_view volume_cell(std::int64_t type);

constexpr std::int64_t vtk_tetrahedron = 10;

/// The bits of vtkGhostType that leave a cell out: DUPLICATECELL and HIDDENCELL, from VTK's
/// vtkDataSetAttributes.h.
constexpr unsigned vtk_left_out = 1 | 32;

/// Whether a cell of this type is a tetrahedron of an order above one. Its first four points are the corners.
constexpr bool is_curved_tetrahedron(std::int64_t type) { return type == 24 || type == 71 || type == 78; }

/// The name of a cell that `reading` refuses, with its remedy; empty: it is read or skipped.
struct Refusal {
    std::string_view name, remedy;
};
Refusal refusal_of(std::int64_t type, std::uint64_t points, const MeshReading& reading);

template<class In>
void read_points(In& in, Number type, std::uint64_t n, Mesh& mesh) {
    in.check_count(n, 3, 3 * size_of(type), "points");
    mesh.vertices.reserve(mesh.vertices.size() + n);
    for (std::uint64_t i = 0; i < n; ++i) {
        const double x = get_real(in, type, "coordinate x");
        const double y = get_real(in, type, "coordinate y");
        const double z = get_real(in, type, "coordinate z");
        mesh.vertices.emplace_back(x, y, z);
    }
}

/// Reads the pressures of n points.
template<class In>
void read_pressures(In& in, Number type, std::uint64_t n, Mesh& mesh) {
    in.check_count(n, 1, size_of(type), "pressures");
    mesh.pressures.reserve(mesh.pressures.size() + n);
    for (std::uint64_t i = 0; i < n; ++i) mesh.pressures.push_back(get_real(in, type, "a pressure"));
}

/// Reads n vertex numbers into `cells`, each below `points`.
template<class In>
void read_connectivity(In& in, Number type, std::uint64_t n, std::size_t points, VtkCells& cells) {
    in.check_count(n, 1, size_of(type), "vertex numbers");
    cells.vertices.reserve(cells.vertices.size() + n);
    for (std::uint64_t i = 0; i < n; ++i)
        cells.vertices.push_back(check_index(in, get_whole(in, type, "a vertex number"), 0, points));
}

/// Reads the ends of n cells. The connectivity can follow later in the file.
template<class In>
void read_ends(In& in, Number type, std::uint64_t n, VtkCells& cells) {
    in.check_count(n, 1, size_of(type), "offsets");
    cells.ends.reserve(n);
    std::uint64_t last = 0;
    for (std::uint64_t i = 0; i < n; ++i) {
        const auto end = get_whole(in, type, "an offset");
        if (end < 0 || static_cast<std::uint64_t>(end) < last)
            in.fail(fmt::format("offset {} is below the previous offset", end), "export the file again");
        last = static_cast<std::uint64_t>(end);
        cells.ends.push_back(last);
    }
}

/// Adds a cell that is not refused: tetrahedra to the mesh, others to its findings.
void add_cell(std::int64_t type, std::span<const std::uint32_t> points, std::size_t base, Mesh& mesh);

/// Reads the types of all cells and keeps the tetrahedra, whose vertex numbers count from `base`.
template<class In>
void read_types(In& in, Number type, const VtkCells& cells, std::size_t base, const MeshReading& reading,
                Mesh& mesh) {
    in.check_count(cells.ends.size(), 1, size_of(type), "cell types");
    std::uint64_t begin = 0;
    for (std::size_t i = 0; i < cells.ends.size(); ++i) {
        const auto kind = get_whole(in, type, "a cell type");
        const auto points = std::span(cells.vertices).subspan(begin, cells.ends[i] - begin);
        begin = cells.ends[i];
        if (!cells.ghosts.empty() && (cells.ghosts[i] & vtk_left_out) != 0) {
            ++mesh.findings.ghosts;
            continue;
        }
        const auto refusal = refusal_of(kind, points.size(), reading);
        if (!refusal.name.empty())
            in.fail(fmt::format("cells of type {} ({}) are not linear tetrahedra", kind, refusal.name),
                    refusal.remedy);
        if ((kind == vtk_tetrahedron && points.size() != 4)
            || (is_curved_tetrahedron(kind) && points.size() < 4))
            in.fail(fmt::format("a tetrahedron has {} vertices", points.size()), "export the file again");
        add_cell(kind, points, base, mesh);
    }
}

} // namespace tandem::read
