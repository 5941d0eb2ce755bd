// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

#include <cctype>

namespace tandem::loader {
namespace {

const std::string rows = R"(# vtk DataFile Version 3.0
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
FIELD FieldData 1
TIME 1 2 double
nan 0
POINTS 6 double
0 0 0 1 0 0 0 1 0
0 0 1.5 -0.25 2 0.125
0.1 0.2 -3e-7
METADATA
INFORMATION 0

CELLS 3 14
3 0 1 2
4 0 1 2 3
4 4 3 2 1
CELL_TYPES 3
5
10
10
POINT_DATA 6
SCALARS s float 1
)";

const std::string offsets = R"(# vtk DataFile Version 5.1
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 6 float
0 0 0 1 0 0 0 1 0
0 0 1.5 -0.25 2 0.125
0.1 0.2 -3e-7
CELLS 4 11
OFFSETS vtktypeint64
0 3 7 11
CONNECTIVITY vtktypeint64
0 1 2 0 1 2 3 4 3 2 1
CELL_TYPES 3
5 10 10
)";

template<class T, class... Values>
std::string big(Values... values) {
    std::string bytes;
    const auto put = [&](T value) {
        std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
        std::reverse(raw.begin(), raw.end());
        bytes += raw;
    };
    (put(static_cast<T>(values)), ...);
    return bytes;
}

template<class T>
std::string points() {
    return big<T>(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1.5, -0.25, 2, 0.125, 0.1, 0.2, -3e-7);
}

const std::string head = "# vtk DataFile Version 3.0\nbinary\nBINARY\nDATASET UNSTRUCTURED_GRID\n";

std::string binary_rows() {
    return head + "FIELD FieldData 1\nTIME 1 1 double\n" + big<double>(7) + "\nPOINTS 6 double\n"
           + points<double>() + "\nCELLS 3 14\n" + big<std::int32_t>(3, 0, 1, 2, 4, 0, 1, 2, 3, 4, 4, 3, 2, 1)
           + "\nCELL_TYPES 3\n" + big<std::int32_t>(5, 10, 10) + "\nCELL_DATA 3\n";
}

std::string binary_offsets() {
    return head + "POINTS 6 float\n" + points<float>() + "\nCELLS 4 11\nOFFSETS vtktypeint64\n"
           + big<std::int64_t>(0, 3, 7, 11) + "\nCONNECTIVITY vtktypeint64\n"
           + big<std::int64_t>(0, 1, 2, 0, 1, 2, 3, 4, 3, 2, 1) + "\nCELL_TYPES 3\n"
           + big<std::int32_t>(5, 10, 10) + "\n";
}

TEST(Vtk, Ascii) {
    expect_example(read_mesh(write_file("rows.vtk", rows)), false);
    expect_example(read_mesh(write_file("offsets.vtk", offsets)), false);
}

TEST(Vtk, Binary) {
    expect_example(read_mesh(write_file("rows.vtk", binary_rows())), false);
    expect_example(read_mesh(write_file("offsets.vtk", binary_offsets())), true);
}

TEST(Vtk, LowerCaseKeywords) {
    auto text = replaced(rows, "ASCII", "ascii");
    for (const auto* word : {"DATASET UNSTRUCTURED_GRID", "POINTS", "CELLS", "CELL_TYPES", "FIELD"}) {
        std::string lower(word);
        std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
        text = replaced(text, word, lower);
    }
    expect_example(read_mesh(write_file("lower.vtk", text)), false);
}

TEST(Vtk, LagrangeTetrahedraOfFourPoints) {
    expect_example(read_mesh(write_file("lagrange.vtk", replaced(rows, "5\n10\n10", "5\n71\n10"))), false);
}

TEST(Vtk, FieldsOfOtherTypes) {
    const std::string field = "FIELD FieldData 1\nTIME 1 2 double\nnan 0\n";
    for (const auto* type :
         {"long\n-7 8\n", "unsigned_long\n7 8\n", "bit\n1 0\n", "string\none more\ntwo\n"}) {
        const auto other = std::string("FIELD FieldData 1\nTIME 1 2 ") + type;
        expect_example(read_mesh(write_file("field.vtk", replaced(rows, field, other))), false);
    }
    const auto binary = "TIME 1 1 double\n" + big<double>(7);
    const auto with = [&](const std::string& array) {
        return write_file("field.vtk", replaced(binary_rows(), binary, array));
    };
    expect_example(read_mesh(with("TIME 1 1 long\n" + big<std::int64_t>(7))), false);
    expect_example(read_mesh(with("BITS 1 9 bit\n" + std::string("\xff\x80", 2))), false);
    // The two highest bits of a length are 3 for one byte, 2 for two bytes.
    expect_example(read_mesh(with("WORDS 1 2 string\n" + std::string("\xc3one\x80\x05three", 11))), false);
}

TEST(Vtk, OtherCells) {
    expect_failure("hex.vtk", replaced(rows, "5\n10\n10", "5\n10\n12"), ":22",
                   "cells of type 12 (hexahedron)");
    expect_failure("odd.vtk", replaced(rows, "5\n10\n10", "5\n10\n99"), ":22", "cells of type 99 (unknown)");
    expect_failure("three.vtk", replaced(rows, "5\n10\n10", "10\n10\n10"), ":20",
                   "a tetrahedron has 3 vertices");
    expect_failure("second.vtk", replaced(binary_rows(), big<std::int32_t>(5, 10), big<std::int32_t>(5, 24)),
                   ": byte ", "cells of type 24 (quadratic tetrahedron)");
}

TEST(Vtk, BadNumbers) {
    expect_failure("nan.vtk", replaced(rows, "0 0 1.5", "0 0 nan"), ":10",
                   "coordinate z 'nan' is not finite");
    expect_failure("index.vtk", replaced(rows, "4 4 3 2 1", "4 4 3 6 1"), ":18", "vertex 6 is out of range");
    expect_failure("one.vtk", replaced(rows, "4 4 3 2 1", "4 5 4 3 6"), ":18",
                   "the mesh has 0 to 5; number vertices from 0");
    expect_failure("index5.vtk", replaced(offsets, "4 3 2 1\n", "4 3 2 -1\n"), ":13",
                   "vertex -1 is out of range");
    expect_failure("order.vtk", replaced(offsets, "0 3 7 11", "0 7 3 11"), ":11", "offset 3 is below");
    const auto inf = std::numeric_limits<double>::infinity();
    expect_failure("inf.vtk", replaced(binary_rows(), big<double>(1.5), big<double>(inf)), ": byte 214",
                   "coordinate z is not finite");
    expect_failure("indexb.vtk",
                   replaced(binary_rows(), big<std::int32_t>(4, 4, 3), big<std::int32_t>(4, 4, 9)), ": byte ",
                   "vertex 9 is out of range");
}

TEST(Vtk, BadCounts) {
    expect_failure("points.vtk", replaced(rows, "POINTS 6", "POINTS 66666"), ":8", "66666 points announced");
    expect_failure("cells.vtk", replaced(rows, "CELLS 3 14", "CELLS 3 77777"), ":15",
                   "77777 numbers of cells");
    expect_failure("rows.vtk", replaced(rows, "CELLS 3 14", "CELLS 3 13"), ":18", "does not fit");
    expect_failure("left.vtk", replaced(rows, "CELLS 3 14", "CELLS 3 15"), ":18", "1 numbers are left over");
    expect_failure("types.vtk", replaced(rows, "CELL_TYPES 3", "CELL_TYPES 2"), ":19",
                   "2 cell types for 3 cells");
    expect_failure("last.vtk", replaced(offsets, "0 3 7 11", "0 3 7 10"), ":13",
                   "the last offset is not the size");
    expect_failure("pointsb.vtk", replaced(binary_rows(), "POINTS 6", "POINTS 4000000000"), ": byte ",
                   "4000000000 points announced");
}

TEST(Vtk, BadStructure) {
    expect_failure("grid.vtk", replaced(rows, "UNSTRUCTURED_GRID", "POLYDATA"), ":4", "found 'POLYDATA'");
    expect_failure("mode.vtk", replaced(rows, "ASCII", "HEX"), ":3", "expected ASCII or BINARY, found 'HEX'");
    expect_failure("type.vtk", replaced(rows, "POINTS 6 double", "POINTS 6 bit"), ":8", "number type 'bit'");
    expect_failure("less.vtk", replaced(rows, "POINTS 6", "POINTS 5"), ":11", "unknown keyword '0.1'");
    expect_failure("cut.vtk", rows.substr(0, rows.find("10\n10")), ":19", "3 cell types announced");
    expect_failure("none.vtk", rows.substr(0, rows.find("CELLS")), ": ", "no tetrahedra");
    expect_failure("other.vtk", "solid\n", ":1", "expected '# vtk DataFile Version'");
}

/// A file truncated before the end of its cell types gives an error, never a crash.
TEST(Vtk, Truncated) {
    for (const auto& whole : {binary_rows(), binary_offsets()})
        for (std::size_t size = 0; size < whole.find("CELL_TYPES") + 25; ++size)
            expect_failure("cut.vtk", whole.substr(0, size), ":", "; ");
}

} // namespace
} // namespace tandem::loader
