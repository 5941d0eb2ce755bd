// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

const std::string example = R"(# Vega mesh file.
*VERTICES
6 3 0 0
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1.5
5 -0.25 2 0.125
6 0.1 0.2 -3e-7

*ELEMENTS
TET
2 4 0
1 1 2 3 4
2 5 4 3 2

*MATERIAL steel
ENU, 7800, 2e11, 0.3
)";

TEST(Veg, Ascii) { expect_example(read_mesh(write_file("two.veg", example)), false); }

TEST(Veg, FromZero) {
    const std::string text = "*VERTICES\n6 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1.5\n4 -0.25 2 0.125\n"
                             "5 0.1 0.2 -3e-7\n*ELEMENTS\nTETS\n2 4\n0 0 1 2 3\n1 4 3 2 1\n";
    expect_example(read_mesh(write_file("zero.veg", text)), false);
}

TEST(Veg, BadInput) {
    expect_failure("cubic.veg", replaced(example, "TET", "CUBIC"), ":12", "cells of type 'CUBIC'");
    expect_failure("index.veg", replaced(example, "5 4 3 2", "5 4 3 8"), ":15", "vertex 8 is out of range");
    expect_failure("nan.veg", replaced(example, "0 0 1.5", "0 nan 1.5"), ":7", "'nan' is not finite");
    expect_failure("count.veg", replaced(example, "6 3 0 0", "60000 3 0 0"), ":3",
                   "60000 vertices announced");
    expect_failure("cells.veg", replaced(example, "2 4 0", "70000 4 0"), ":13", "70000 tetrahedra announced");
    expect_failure("order.veg", replaced(example, "4 0 0 1.5", "9 0 0 1.5"), ":7",
                   "vertex 9 is out of order");
    expect_failure("cut.veg", example.substr(0, example.find("6 0.1")) + "6 0.1 0.2", ":9",
                   "the file ends before");
    expect_example(read_mesh(write_file("set.veg", example + "*SET fixed\n*INCLUDE other.txt\n")), false);
    expect_failure("include.veg", "*VERTICES\n0 3 0 0\n*INCLUDE other.veg\n", ":3",
                   "*INCLUDE is not supported");
    expect_failure("early.veg", "*ELEMENTS\nTET\n", ":1", "before *VERTICES");
    expect_failure("empty.veg", example.substr(0, example.find("*ELEMENTS")), ": ", "no tetrahedra");
}

} // namespace
} // namespace tandem::loader
