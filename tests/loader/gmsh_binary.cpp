// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

template<class... T>
std::string raw(T... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
    return bytes;
}

template<class... T>
std::string ints(T... values) {
    return raw(static_cast<std::int32_t>(values)...);
}

template<class... T>
std::string sizes(T... values) {
    return raw(static_cast<std::uint64_t>(values)...);
}

const std::string head2 = "$MeshFormat\n2.2 1 8\n" + ints(1) + "\n$EndMeshFormat\n";
const std::string head4 = "$MeshFormat\n4.1 1 8\n" + ints(1) + "\n$EndMeshFormat\n";

std::string version2() {
    return head2 + "$Nodes\n6\n" + ints(1) + raw(0., 0., 0.) + ints(2) + raw(1., 0., 0.) + ints(3)
           + raw(0., 1., 0.) + ints(4) + raw(0., 0., 1.5) + ints(5) + raw(-0.25, 2., 0.125) + ints(6)
           + raw(0.1, 0.2, -3e-7) + "\n$EndNodes\n$Elements\n3\n" + ints(2, 1, 2, /**/ 1, 0, 1, 1, 2, 3)
           + ints(4, 2, 1, /**/ 2, 7, 1, 2, 3, 4, /**/ 3, 7, 5, 4, 3, 2) + "\n$EndElements\n";
}

std::string version4() {
    return head4 + "$Nodes\n" + sizes(2, 6, 10, 60) + ints(1, 1, 1) + sizes(2, 30, 10)
           + raw(0., 0., 0., 0.5, /**/ 1., 0., 0., 0.75) + ints(3, 1, 0) + sizes(4, 20, 40, 50, 60)
           + raw(0., 1., 0., 0., 0., 1.5, -0.25, 2., 0.125, 0.1, 0.2, -3e-7) + "\n$EndNodes\n$Elements\n"
           + sizes(2, 3, 1, 3) + ints(2, 1, 2) + sizes(1, 1, 10, 20, 30) + ints(3, 1, 4)
           + sizes(2, 2, 30, 10, 20, 40, 3, 50, 40, 20, 10) + "\n$EndElements\n";
}

/// Pressures of nodes with these tags, in the order of the example's vertices.
std::string pressures(int a, int b, int c, int d, int e, int f) {
    return "$NodeData\n1\n\"pressure\"\n1\n0\n3\n0\n1\n6\n" + ints(f) + raw(0.125) + ints(a) + raw(0.)
           + ints(b) + raw(0.5) + ints(c) + raw(1.25) + ints(d) + raw(0.) + ints(e) + raw(3e7)
           + "\n$EndNodeData\n";
}

TEST(GmshBinary, Pressures) {
    expect_pressures("two.msh", version2() + pressures(1, 2, 3, 4, 5, 6));
    expect_pressures("four.msh", version4() + pressures(30, 10, 20, 40, 50, 60));
    const auto other = replaced(pressures(9, 9, 9, 9, 9, 9), "pressure", "p");
    expect_pressures("others.msh", version2() + other + pressures(1, 2, 3, 4, 5, 6) + other);
}

TEST(GmshBinary, BadPressures) {
    const auto whole = version2() + pressures(1, 2, 3, 4, 5, 6);
    expect_failure("node.msh", version2() + pressures(1, 2, 3, 4, 5, 9), ": byte ",
                   "node 9 is not in $Nodes");
    expect_failure("less.msh", replaced(whole, "0\n1\n6\n", "0\n1\n5\n"), ": byte ",
                   "leaves out 1 of 6 nodes, such as node 5");
    expect_failure("many.msh", replaced(whole, "0\n1\n6\n", "0\n1\n6000\n"), ": byte ",
                   "6000 pressures announced");
    const auto nan = std::numeric_limits<double>::quiet_NaN();
    expect_failure("nan.msh", replaced(whole, raw(3e7), raw(nan)), ": byte ", "a pressure is not finite");
    expect_failure("negative.msh", replaced(whole, raw(3e7), raw(-1.)), ": ",
                   "the pressure of vertex 4 is -1");
    for (auto size = version2().size() + 1; size + 1 < whole.size(); ++size)
        expect_failure("cut.msh", whole.substr(0, size), ": ", "; ");
}

TEST(GmshBinary, Version2) { expect_example(read_mesh(write_file("two.msh", version2())), false); }

TEST(GmshBinary, Version4ParametricAndGappyTags) {
    expect_example(read_mesh(write_file("four.msh", version4())), false);
}

TEST(GmshBinary, OtherElements) {
    expect_failure("hex2.msh", replaced(version2(), ints(4, 2, 1), ints(5, 2, 1)), ": byte 276",
                   "element type 5 (8-node hexahedron)");
    expect_failure("hex4.msh", replaced(version4(), ints(3, 1, 4), ints(3, 1, 5)), ": byte ",
                   "element type 5 (8-node hexahedron)");
}

TEST(GmshBinary, BadNumbers) {
    const auto nan = std::numeric_limits<double>::quiet_NaN();
    const auto inf = std::numeric_limits<double>::infinity();
    expect_failure("nan2.msh", replaced(version2(), raw(1.5), raw(nan)), ": byte 153",
                   "coordinate z is not finite");
    expect_failure("inf4.msh", replaced(version4(), raw(1.5), raw(-inf)), ": byte ",
                   "coordinate z is not finite");
    expect_failure("index2.msh", replaced(version2(), ints(5, 4, 3), ints(5, 4, 9)), ": byte ",
                   "node 9 is not in $Nodes");
    expect_failure("index4.msh", replaced(version4(), sizes(50, 40, 20), sizes(50, 41, 20)), ": byte ",
                   "node 41 is not in $Nodes");
}

TEST(GmshBinary, BadCounts) {
    expect_failure("nodes2.msh", replaced(version2(), "\n6\n", "\n4000000000\n"), ": byte ",
                   "4000000000 nodes announced");
    expect_failure("run2.msh", replaced(version2(), ints(4, 2, 1), ints(4, 3, 1)), ": byte ",
                   "a run of 3 elements");
    expect_failure("block4.msh", replaced(version4(), sizes(4, 20), sizes(1ull << 61, 20)), ": byte ",
                   "nodes announced");
    expect_failure("cells4.msh", replaced(version4(), sizes(2, 2, 30), sizes(1ull << 40, 2, 30)), ": byte ",
                   "elements announced");
    expect_failure("sum4.msh", replaced(version4(), sizes(2, 6), sizes(2, 5)), ": byte ",
                   "the blocks have 6 nodes, the first line announces 5");
}

TEST(GmshBinary, BadStructure) {
    expect_failure("big.msh", replaced(version2(), ints(1), std::string("\0\0\0\1", 4)), ": byte 20",
                   "big endian");
    expect_failure("end2.msh", replaced(version2(), "$EndNodes", "$EndNoise"), ": byte ",
                   "$EndNodes is missing");
}

/// A file truncated before the end of its last section gives an error that names a byte, never a crash.
TEST(GmshBinary, Truncated) {
    for (const auto& whole : {version2(), version4()})
        for (auto size = head2.size(); size + 1 < whole.size(); ++size)
            expect_failure("cut.msh", whole.substr(0, size), ": ", "; ");
}

} // namespace
} // namespace tandem::loader
