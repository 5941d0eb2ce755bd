// SPDX-License-Identifier: MIT
// MSH 4.0, as Gmsh 4.0 writes it: version 4, the tag of an entity before its dimension, a node's tag beside
// it.
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

const std::string text40 = R"($MeshFormat
4 0 8
$EndMeshFormat
$Entities
1 0 0 1
1 0 0 0 0 0 0 0
1 -1 0 0 1 2 2 0 0
$EndEntities
$Nodes
2 6
1 1 1 2
30 0 0 0 0.5
10 1 0 0 0.75
1 3 0 4
20 0 1 0
40 0 0 1.5
50 -0.25 2 0.125
60 0.1 0.2 -3e-7
$EndNodes
$Elements
2 3
1 2 2 1
1 10 20 30
1 3 4 2
2 30 10 20 40
3 50 40 20 10
$EndElements
)";

/// Adds the bytes of numbers.
template<class... T>
std::string bytes_of(T... values) {
    std::string bytes;
    (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
    return bytes;
}

std::string row_of(int tag, double x, double y, double z) { return bytes_of(tag, x, y, z); }

std::string block_of(int tag, int dimension, int third, std::uint64_t count) {
    return bytes_of(tag, dimension, third, count);
}

std::string totals_of(std::uint64_t blocks, std::uint64_t count) { return bytes_of(blocks, count); }

std::string binary40() {
    return "$MeshFormat\n4 1 8\n" + bytes_of(1) + "\n$EndMeshFormat\n$Nodes\n" + totals_of(2, 6)
           + block_of(1, 1, 1, 2) + row_of(30, 0, 0, 0) + bytes_of(0.5) + row_of(10, 1, 0, 0) + bytes_of(0.75)
           + block_of(1, 3, 0, 4) + row_of(20, 0, 1, 0) + row_of(40, 0, 0, 1.5) + row_of(50, -0.25, 2, 0.125)
           + row_of(60, 0.1, 0.2, -3e-7) + "\n$EndNodes\n$Elements\n" + totals_of(2, 3) + block_of(1, 2, 2, 1)
           + bytes_of(1, 10, 20, 30) + block_of(1, 3, 4, 2) + bytes_of(2, 30, 10, 20, 40, 3, 50, 40, 20, 10)
           + "\n$EndElements\n";
}

TEST(Gmsh40, IsReadInBothEncodings) {
    expect_example(read_mesh(write_file("forty.msh", text40)), false);
    expect_example(read_mesh(write_file("forty.msh", replaced(text40, "\n4 0 8", "\n4.0 0 8"))), false);
    expect_example(read_mesh(write_file("forty.msh", binary40())), false);
}

TEST(Gmsh40, PressuresInBothEncodings) {
    const std::string head = "$NodeData\n1\n\"pressure\"\n1\n0\n3\n0\n1\n6\n", end = "$EndNodeData\n";
    expect_pressures("text.msh", text40 + head + "60 0.125\n30 0\n10 0.5\n20 1.25\n40 0\n50 3e7\n" + end);
    expect_pressures("binary.msh", binary40() + head + bytes_of(60) + bytes_of(0.125) + bytes_of(30)
                                       + bytes_of(0.) + bytes_of(10) + bytes_of(0.5) + bytes_of(20)
                                       + bytes_of(1.25) + bytes_of(40) + bytes_of(0.) + bytes_of(50)
                                       + bytes_of(3e7) + "\n" + end);
}

TEST(Gmsh40, BadFilesAreRefused) {
    expect_failure("type.msh", replaced(text40, "1 3 4 2", "1 3 5 2"), ":24", "8-node hexahedron");
    expect_failure("node.msh", replaced(text40, "50 40 20 10", "50 41 20 10"), ":26",
                   "node 41 is not in $Nodes");
    expect_failure("nodes.msh", replaced(text40, "\n2 6\n", "\n2 5\n"), ":", "the blocks have 6 nodes");
    expect_failure("elements.msh", replaced(text40, "\n2 3\n1 2", "\n2 4\n1 2"), ":",
                   "the blocks have 3 elements");
    expect_failure("twice.msh", replaced(text40, "40 0 0", "50 0 0"), ":", "node 50 occurs twice");
    const auto large = std::uint64_t{1} << 60;
    expect_failure("many.msh", replaced(binary40(), totals_of(2, 6), totals_of(2, large)), ": byte ",
                   "nodes");
    expect_failure("large.msh", replaced(binary40(), block_of(1, 3, 4, 2), block_of(1, 3, 4, large)),
                   ": byte ", "elements");
    for (std::size_t size = 60; size < binary40().size() - 12; size += 7)
        expect_failure("cut.msh", binary40().substr(0, size), ":", "");
}

} // namespace
} // namespace tandem::loader
