// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

const std::string example = R"(MeshVersionFormatted 2
# two tetrahedra
Dimension
3
Vertices
6
0 0 0 0
1 0 0 0
0 +1 0 7
0 0 1.5 0
-.25 2e0 0.125 0
0.1 0.2 -3E-7 0
Triangles
1
1 2 3 5
Tetrahedra
2
1 2 3 4 0
5 4 3 2 9
RequiredVertices 1
1
End
)";

TEST(Medit, Ascii) {
    const auto mesh = read_mesh(write_file("two.mesh", example));
    expect_example(mesh, false);
    EXPECT_EQ(mesh.name, "two");
}

TEST(Medit, RecognisedByContent) { expect_example(read_mesh(write_file("two.txt", example)), false); }

TEST(Medit, WindowsLines) {
    std::string text;
    for (const char c : example) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    expect_example(read_mesh(write_file("windows.mesh", text)), false);
}

TEST(Medit, NoFinalNewline) {
    const auto text = example.substr(0, example.find("\nRequired"));
    expect_example(read_mesh(write_file("short.mesh", text)), false);
}

TEST(Medit, OtherCells) {
    expect_failure("hexes.mesh", replaced(example, "Required", "Hexahedra 1\n1 2 3 4 5 6 1 2 0\nRequired"),
                   ":20", "cells of type 'Hexahedra' are not linear tetrahedra");
    expect_failure("second.mesh", replaced(example, "Tetrahedra", "TetrahedraP2"), ":17",
                   "cells of type 'TetrahedraP2'");
}

TEST(Medit, NoOtherCells) {
    const auto text = replaced(example, "Required", "Hexahedra 0\nRequired");
    expect_example(read_mesh(write_file("nohexes.mesh", text)), false);
}

TEST(Medit, BadNumbers) {
    expect_failure("index.mesh", replaced(example, "5 4 3 2", "5 4 3 7"), ":19", "vertex 7 is out of range");
    expect_failure("zero.mesh", replaced(example, "5 4 3 2", "5 0 3 2"), ":19", "vertex 0 is out of range");
    expect_failure("nan.mesh", replaced(example, "1 0 0 0", "1 nan 0 0"), ":8",
                   "coordinate y 'nan' is not finite");
    expect_failure("inf.mesh", replaced(example, "1 0 0 0", "-inf 0 0 0"), ":8", "'-inf' is not finite");
    expect_failure("huge.mesh", replaced(example, "1 0 0 0", "1e999 0 0 0"), ":8", "'1e999' is out of range");
    expect_failure("word.mesh", replaced(example, "1 0 0 0", "1 x 0 0"), ":8",
                   "expected coordinate y, found 'x'");
}

TEST(Medit, BadStructure) {
    expect_failure("count.mesh", replaced(example, "\n6\n", "\n4000000000\n"), ":6",
                   "4000000000 vertices announced");
    expect_failure("negative.mesh", replaced(example, "\n6\n", "\n-6\n"), ":6", "found '-6'");
    expect_failure("more.mesh", replaced(example, "\n6\n", "\n5\n"), ":12",
                   "expected a keyword, found '0.1'");
    expect_failure("cut.mesh", example.substr(0, example.find("5 4 3 2")), ":17", "2 tetrahedra announced");
    expect_failure("flat.mesh", replaced(example, "\n3\n", "\n2\n"), ":4", "the dimension is not 3");
    expect_failure("early.mesh", "MeshVersionFormatted 1\nDimension 3\nTetrahedra 0", ":3",
                   "before Vertices");
    expect_failure("other.mesh", "solid cube\n", ":1", "expected MeshVersionFormatted, found 'solid'");
}

TEST(Medit, NoTetrahedra) {
    expect_failure("surface.mesh", replaced(example, "Tetrahedra\n2\n1 2 3 4 0\n5 4 3 2 9\n", ""), ": ",
                   "no tetrahedra");
}

} // namespace
} // namespace tandem::loader
