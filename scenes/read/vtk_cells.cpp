// SPDX-License-Identifier: MIT
#include "scenes/read/vtk_cells.h"

#include <algorithm>
#include <array>
#include <limits>

namespace tandem::read {

namespace {

struct Name {
    std::string_view name;
    Number type;
};

constexpr std::array names = {
    Name{"Float32", Number::f32},   Name{"float", Number::f32},
    Name{"Float64", Number::f64},   Name{"double", Number::f64},
    Name{"Int8", Number::i8},       Name{"char", Number::i8},
    Name{"UInt8", Number::u8},      Name{"unsigned_char", Number::u8},
    Name{"Int16", Number::i16},     Name{"short", Number::i16},
    Name{"UInt16", Number::u16},    Name{"unsigned_short", Number::u16},
    Name{"Int32", Number::i32},     Name{"int", Number::i32},
    Name{"UInt32", Number::u32},    Name{"unsigned_int", Number::u32},
    Name{"Int64", Number::i64},     Name{"vtktypeint64", Number::i64},
    Name{"UInt64", Number::u64},    Name{"vtktypeuint64", Number::u64},
    Name{"long", Number::i64},      Name{"unsigned_long", Number::u64},
    Name{"vtkIdType", Number::i32}, // the legacy writer stores ids in 32 bits
};

struct VtkCell {
    std::int64_t type;
    std::string_view name;
};

/// Cells of dimension 3, from VTK's vtkCellType.h.
constexpr std::array volume_cells = {
    VtkCell{11, "voxel"},
    VtkCell{12, "hexahedron"},
    VtkCell{13, "wedge"},
    VtkCell{14, "pyramid"},
    VtkCell{15, "pentagonal prism"},
    VtkCell{16, "hexagonal prism"},
    VtkCell{24, "quadratic tetrahedron"},
    VtkCell{25, "quadratic hexahedron"},
    VtkCell{26, "quadratic wedge"},
    VtkCell{27, "quadratic pyramid"},
    VtkCell{29, "triquadratic hexahedron"},
    VtkCell{31, "quadratic linear wedge"},
    VtkCell{32, "biquadratic quadratic wedge"},
    VtkCell{33, "biquadratic quadratic hexahedron"},
    VtkCell{37, "triquadratic pyramid"},
    VtkCell{42, "polyhedron"},
    VtkCell{71, "Lagrange tetrahedron"},
    VtkCell{72, "Lagrange hexahedron"},
    VtkCell{73, "Lagrange wedge"},
    VtkCell{74, "Lagrange pyramid"},
    VtkCell{78, "Bezier tetrahedron"},
    VtkCell{79, "Bezier hexahedron"},
    VtkCell{80, "Bezier wedge"},
    VtkCell{81, "Bezier pyramid"},
};

/// Cells of lower dimension.
constexpr std::array<std::int64_t, 27> flat_cells = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  21, 22, 23, 28,
                                                     30, 34, 35, 36, 51, 68, 69, 70, 75, 76, 77, 60, 61};

} // namespace

bool same_word(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

std::optional<Number> number_type(std::string_view name) {
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const Name& n) { return same_word(n.name, name); });
    return found == names.end() ? std::nullopt : std::optional(found->type);
}

std::size_t size_of(Number type) {
    switch (type) {
    case Number::i8:
    case Number::u8:
        return 1;
    case Number::i16:
    case Number::u16:
        return 2;
    case Number::f32:
    case Number::i32:
    case Number::u32:
        return 4;
    default:
        return 8;
    }
}

std::string_view volume_cell(std::int64_t type) {
    if (std::find(flat_cells.begin(), flat_cells.end(), type) != flat_cells.end()) return "";
    const auto found = std::find_if(volume_cells.begin(), volume_cells.end(),
                                    [&](const VtkCell& cell) { return cell.type == type; });
    return found == volume_cells.end() ? "unknown" : found->name;
}

Refusal refusal_of(std::int64_t type, std::uint64_t points, const MeshReading& reading) {
    const bool is_linear = type == vtk_tetrahedron || (type == 71 && points == 4);
    const bool is_curved = is_curved_tetrahedron(type);
    if (is_linear || (is_curved ? reading.corners : reading.only_tetrahedra)) return {};
    return {volume_cell(type), is_curved ? corners_remedy : only_remedy};
}

void add_cell(std::int64_t type, std::span<const std::uint32_t> points, std::size_t base, Mesh& mesh) {
    if (type != vtk_tetrahedron && !is_curved_tetrahedron(type)) {
        mesh.findings.other_cells += volume_cell(type).empty() ? 0 : 1;
        return;
    }
    Tetrahedron corners{};
    for (std::size_t i = 0; i < 4; ++i) corners[i] = static_cast<std::uint32_t>(base) + points[i];
    mesh.tetrahedra.push_back(corners);
    mesh.findings.reduced += points.size() > 4 ? 1 : 0;
}

double get_real(Scanner& in, Number, std::string_view what) { return in.get<double>(what); }

double get_real(Cursor& in, Number type, std::string_view what) {
    if (type == Number::f64) return in.get<double>(what);
    if (type == Number::f32) return static_cast<double>(in.get<float>(what));
    return static_cast<double>(get_whole(in, type, what));
}

std::int64_t get_whole(Scanner& in, Number, std::string_view what) { return in.get<std::int64_t>(what); }

std::int64_t get_whole(Cursor& in, Number type, std::string_view what) {
    switch (type) {
    case Number::i8:
        return in.get<std::int8_t>(what);
    case Number::u8:
        return in.get<std::uint8_t>(what);
    case Number::i16:
        return in.get<std::int16_t>(what);
    case Number::u16:
        return in.get<std::uint16_t>(what);
    case Number::i32:
        return in.get<std::int32_t>(what);
    case Number::u32:
        return in.get<std::uint32_t>(what);
    case Number::i64:
        return in.get<std::int64_t>(what);
    case Number::u64:
        break;
    default:
        in.fail(fmt::format("{} is stored as a float", what), "store it as an integer");
    }
    const auto value = in.get<std::uint64_t>(what);
    if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        in.fail(fmt::format("{} {} is out of range", what, value), "repair the mesh");
    return static_cast<std::int64_t>(value);
}

} // namespace tandem::read
