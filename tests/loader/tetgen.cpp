// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"
#include "base/error.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

const std::string node =
    "# made by hand\n6 3\n\n0 0 0 0\n1 1 0 0 # right\n2 0 1 0\n3 0 0 1.5\n4 -0.25 2 0.125\n"
    "5 0.1 0.2 -3e-7\n";
const std::string ele = "2 4 0\n0 0 1 2 3\n1 4 3 2 1\n# end\n";

TEST(Tetgen, EitherFileNamesThePair) {
    const auto first = write_file("pair.node", node);
    const auto second = write_file("pair.ele", ele);
    expect_example(read_mesh(first), false);
    const auto mesh = read_mesh(second);
    expect_example(mesh, false);
    EXPECT_EQ(mesh.name, "pair");
}

TEST(Tetgen, FromOneWithAttributesAndMarkers) {
    write_file("one.node", "6 3 2 1\n1 0 0 0 9 8 1\n2 1 0 0 9 8 1\n3 0 1 0 9 nan 1\n4 0 0 1.5 9 8 1\n"
                           "5 -0.25 2 0.125 9 8 0\n6 0.1 0.2 -3e-7 9 8 -1\n");
    const auto path = write_file("one.ele", "2 4 1\n1 1 2 3 4 17\n2 5 4 3 2 0.5\n");
    expect_example(read_mesh(path), false);
}

TEST(Tetgen, BadNodes) {
    write_file("nodes.ele", ele);
    const auto fails = [](std::string_view from, std::string_view to, const std::string& location,
                          std::string_view reason) {
        expect_failure("nodes.node", replaced(node, from, to), location, reason);
    };
    fails("0 0 1.5", "0 inf 1.5", ":7", "'inf' is not finite");
    fails("6 3", "6 2", ":2", "the dimension is not 3");
    fails("6 3", "6 3 1 0", ":6", "expected the row with number 2");
    fails("0 0 0 0", "2 0 0 0", ":4", "neither 0 nor 1");
    fails("6 3", "9999999 3", ":2", "9999999 vertices announced");
    fails("6 3", "5 3", ":9", "more rows than the first line announces");
    fails("5 0.1 0.2 -3e-7\n", "", ":9", "the file ends before");
}

TEST(Tetgen, BadElements) {
    write_file("elements.node", node);
    const auto fails = [](std::string_view from, std::string_view to, const std::string& location,
                          std::string_view reason) {
        expect_failure("elements.ele", replaced(ele, from, to), location, reason);
    };
    fails("2 4 0", "2 10 0", ":1", "second-order tetrahedron");
    fails("2 4 0", "2 8 0", ":1", "cells of 8 vertices");
    fails("4 3 2 1", "4 3 2 6", ":3", "vertex 6 is out of range");
    fails("4 3 2 1", "4 3 2 -1", ":3", "vertex -1 is out of range");
    fails("2 4 0", "1000000 4 0", ":1", "1000000 tetrahedra announced");
    fails("1 4 3 2 1", "1 4 3 2 # 1", ":5", "the file ends before a vertex number");
    fails(ele, "0 4 0\n", ": ", "no tetrahedra");
    fails(ele, "", ":1", "the file ends before the number of rows");
}

TEST(Tetgen, MissingPartner) {
    const auto expect = [](const std::string& path, const std::string& missing) {
        EXPECT_EQ(support::message_of([&] { read_mesh(path); }),
                  missing + ": missing, the partner of " + path + "; put both into one folder");
    };
    expect(write_file("lonely.node", node), folder() + "/lonely.ele");
    expect(write_file("alone.ele", ele), folder() + "/alone.node");
}

} // namespace
} // namespace tandem::loader
