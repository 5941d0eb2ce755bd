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

const std::string scalars = "SCALARS pressure double 1\nLOOKUP_TABLE default\n0 0.5 1.25\n0 3e7 0.125\n";

/// The example of text with other data of its points.
std::string with_data(const std::string& data) { return replaced(rows, "SCALARS s float 1\n", data); }

/// The same in binary data, after data of its cells.
std::string with_binary_data(const std::string& data) {
    return binary_rows() + "SCALARS pressure float\nLOOKUP_TABLE default\n" + big<float>(7, 8, 9)
           + "\nPOINT_DATA 6\n" + data;
}

TEST(Vtk, PressuresOfScalars) {
    expect_pressures("scalars.vtk", with_data(scalars));
    expect_pressures("width.vtk", with_data(replaced(scalars, "double 1", "double")));
    expect_pressures("offsets.vtk", offsets + "POINT_DATA 6\n" + scalars);
    const std::string wide = "SCALARS pressure double\nLOOKUP_TABLE default\n";
    expect_pressures("binary.vtk", with_binary_data(wide + big<double>(0, 0.5, 1.25, 0, 3e7, 0.125)));
    expect_pressures("whole.vtk", with_binary_data("SCALARS pressure float\nLOOKUP_TABLE default\n"
                                                   + big<float>(0, 0.5, 1.25, 0, 3e7, 0.125)));
}

TEST(Vtk, PressuresOfFields) {
    const std::string field = "FIELD FieldData 2\nother 2 6 float\n0 1 2 3 4 5 6 7 nan 9 10 11\nMETADATA\n"
                              "INFORMATION 0\n\npressure 1 6 double\n0 0.5 1.25 0 3e7 0.125\n";
    expect_pressures("field.vtk", with_data(field));
    expect_pressures("fieldb.vtk",
                     with_binary_data("FIELD FieldData 2\nother 1 3 int\n" + big<std::int32_t>(10, 32, 9)
                                      + "\nMETADATA\nINFORMATION 0\n\npressure 1 6 double\n"
                                      + big<double>(0, 0.5, 1.25, 0, 3e7, 0.125)));
}

TEST(Vtk, OtherDataAreSkipped) {
    const std::string six = "0 1 2 3 4 5\n", twelve = six + six;
    const std::string others[] = {"SCALARS s float 2\nLOOKUP_TABLE pressure\n" + twelve,
                                  "LOOKUP_TABLE pressure 3\n" + twelve,
                                  "COLOR_SCALARS pressure 2\n" + twelve,
                                  "VECTORS v float\n" + twelve + six,
                                  "NORMALS n double\n" + twelve + six,
                                  "TENSORS t float\n" + twelve + twelve + twelve + twelve + six,
                                  "TENSORS6 t float\n" + twelve + twelve + twelve,
                                  "TEXTURE_COORDINATES uv 2 float\n" + twelve,
                                  "GLOBAL_IDS g vtkIdType\n" + six,
                                  "PEDIGREE_IDS p string\none\ntwo\nthree\nfour\nfive\nsix\n",
                                  "EDGE_FLAGS e bit\n0 1 0 1 0 1\n",
                                  "METADATA\nCOMPONENT_NAMES\npressure\n\n"};
    for (const auto& other : others) {
        SCOPED_TRACE(other);
        expect_pressures("after.vtk", with_data(other + scalars));
        expect_pressures("before.vtk", with_data(scalars + other));
        EXPECT_TRUE(read_mesh(write_file("none.vtk", with_data(other))).pressures.empty());
    }
    const std::string binary[] = {
        "COLOR_SCALARS pressure 1\n" + big<std::uint8_t>(10, 32, 9, 10, 32, 9) + "\n",
        "LOOKUP_TABLE pressure 1\n" + big<std::uint8_t>(10, 32, 9, 10) + "\n",
        "VECTORS v short\n" + big<std::int16_t>(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18)
            + "\n"};
    const auto own =
        "SCALARS pressure double\nLOOKUP_TABLE pressure\n" + big<double>(0, 0.5, 1.25, 0, 3e7, 0.125) + "\n";
    for (const auto& other : binary) {
        expect_pressures("afterb.vtk", with_binary_data(other + own));
        expect_pressures("beforeb.vtk", with_binary_data(own + other));
    }
    const auto of_cells = replaced(replaced(rows, "POINT_DATA 6", "CELL_DATA 3"), "SCALARS s float 1\n",
                                   "SCALARS pressure float\nLOOKUP_TABLE default\n1 2 3\n");
    EXPECT_TRUE(read_mesh(write_file("cells.vtk", of_cells)).pressures.empty());
    EXPECT_TRUE(read_mesh(write_file("other.vtk", with_data("SCALARS Pressure float\n"))).pressures.empty());
}

TEST(Vtk, BadPressures) {
    const auto expect_bad = [](std::string_view from, std::string_view to, const std::string& location,
                               std::string_view reason) {
        expect_failure("pressure.vtk", with_data(replaced(scalars, from, to)), location, reason);
    };
    expect_bad("double 1", "double 3", ":25", "pressure has 6 x 3 numbers for 6 points");
    expect_bad("0 3e7", "-1 3e7", ": ", "the pressure of vertex 3 is -1");
    expect_bad("3e7", "3e39", ": ", "the pressure of vertex 4 is 3e+39");
    expect_bad("3e7", "nan", ":27", "a pressure 'nan' is not finite");
    expect_bad("3e7", "inf", ":27", "a pressure 'inf' is not finite");
    expect_bad("3e7", "high", ":27", "expected a pressure, found 'high'");
    expect_bad(" 0.125", "", ":28", "the file ends before a pressure");
    expect_bad("0 0.5 1.25\n0 3e7 0.125", "1 2", ":25", "6 pressures announced");
    expect_bad("LOOKUP_TABLE default\n", "", ":25", "expected LOOKUP_TABLE, found '0'");
    expect_bad("double", "bit", ":25", "number type 'bit' is not supported");
    expect_bad("0.125\n", "0.125 7\n", ":27", "unknown keyword '7'");
    expect_failure("twice.vtk", with_data(scalars + scalars), ":29", "a second array of point data pressure");
    expect_failure("five.vtk", replaced(with_data(scalars), "POINT_DATA 6", "POINT_DATA 5"), ":25",
                   "pressure has 5 x 1 numbers for 6 points");
    expect_failure("field.vtk", with_data("FIELD FieldData 1\npressure 1 5 float\n0 1 2 3 4\n"), ":25",
                   "pressure has 5 x 1 numbers for 6 points");
    expect_failure("cut.vtk",
                   with_binary_data("SCALARS pressure double\nLOOKUP_TABLE default\n" + big<double>(0, 1)),
                   ": byte ", "6 pressures announced");
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
