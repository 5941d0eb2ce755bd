// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

namespace tandem::loader {
namespace {

const std::string version2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
3 1 "body"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1.5
5 -0.25 2 0.125
6 0.1 0.2 -3e-7
$EndNodes
$Elements
3
1 2 2 0 1 1 2 3
2 4 2 1 1 1 2 3 4
3 4 3 1 1 0 5 4 3 2
$EndElements
)";

const std::string version4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$Nodes
3 6 10 60
2 1 0 2
30
10
0 0 0
1 0 0
2 1 1 1
20
0 1 0 0.5 0.25
3 1 0 3
60
50
40
0 0 1.5
-0.25 2 0.125
0.1 0.2 -3e-7
$EndNodes
$Elements
3 3 1 3
2 1 2 1
1 10 20 30
3 1 4 1
2 30 10 20 60
3 2 4 1
3 50 60 20 10
$EndElements
$Surface
1
1 2 3
$EndSurface
)";

const std::string node_data = R"($NodeData
2
"pressure"
"a second text"
1
0.25
4
0
1
6
0
1 0
2 0.5
4 0
3 1.25
6 0.125
5 3e7
$EndNodeData
)";

const std::string other_data = "$NodeData\n1\n\"other pressure\"\n0\n3\n0\n3\n1\n1 nan 0 0\n$EndNodeData\n";

TEST(GmshAscii, Pressures) {
    expect_pressures("two.msh", version2 + other_data + node_data + other_data);
    auto gappy = node_data;
    for (const auto* tags : {"1 30", "2 10", "4 60", "3 20", "6 40", "5 50"})
        gappy = replaced(gappy, std::string("\n") + tags[0] + " ", std::string("\n") + (tags + 2) + " ");
    // In the example of version 4 node 60 is vertex 3, 50 is 4 and 40 is 5.
    const auto mesh = read_mesh(write_file("four.msh", version4 + gappy));
    EXPECT_EQ(mesh.pressures, (std::vector<double>{0, 0.5, 1.25, 0, 3e7, 0.125}));
    EXPECT_TRUE(read_mesh(write_file("other.msh", version2 + other_data)).pressures.empty());
    const auto of_elements =
        replaced(replaced(node_data, "$NodeData", "$ElementData"), "$EndNodeData", "$EndElementData");
    EXPECT_TRUE(read_mesh(write_file("elements.msh", version2 + of_elements)).pressures.empty());
}

TEST(GmshAscii, BadPressures) {
    const auto expect_bad = [](std::string_view from, std::string_view to, const std::string& location,
                               std::string_view reason) {
        expect_failure("pressure.msh", version2 + replaced(node_data, from, to), location, reason);
    };
    expect_bad("\n1\n6\n", "\n3\n6\n", ":31", "$NodeData pressure has 3 components");
    expect_bad("\n4\n0\n1\n6\n0\n", "\n2\n0\n1\n", ":29", "2 integer tags instead of 3");
    expect_bad("\n6\n0\n1 0\n", "\n5\n0\n", ":",
               "$NodeData pressure leaves out 1 of 6 nodes, such as node 1");
    expect_bad("\n6\n0\n", "\n600\n0\n", ":", "600 pressures announced");
    expect_bad("\n6\n0\n", "\n5\n0\n", ":38", "leaves out 1 of 6 nodes, such as node 5");
    expect_bad("\n6\n0\n", "\n7\n0\n", ":40", "expected the tag of a node");
    expect_bad("4 0\n", "7 0\n", ":36", "node 7 is not in $Nodes");
    expect_bad("4 0\n", "2 0\n", ":36", "node 2 has two pressures");
    expect_bad("3e7", "nan", ":39", "a pressure 'nan' is not finite");
    expect_bad("3e7", "-3e7", ": ", "the pressure of vertex 4 is -30000000");
    expect_failure("twice.msh", version2 + node_data + node_data, ":", "a second $NodeData pressure");
    const auto nodes = version2.find("$Nodes");
    expect_failure("early.msh", version2.substr(0, nodes) + node_data + version2.substr(nodes), ":",
                   "$NodeData comes before $Nodes");
}

TEST(GmshAscii, Version2) { expect_example(read_mesh(write_file("two.msh", version2)), false); }

TEST(GmshAscii, Version4ParametricAndGappyTags) {
    expect_example(read_mesh(write_file("four.msh", version4)), false);
}

TEST(GmshAscii, OtherElements) {
    expect_failure("hex2.msh", replaced(version2, "2 4 2 1", "2 5 2 1"), ":20",
                   "element type 5 (8-node hexahedron)");
    expect_failure("second4.msh", replaced(version4, "3 2 4 1", "3 2 11 1"), ":28",
                   "element type 11 (10-node second-order tetrahedron)");
    expect_failure("odd.msh", replaced(version2, "2 4 2 1", "2 77 2 1"), ":20", "element type 77 is unknown");
}

TEST(GmshAscii, OtherVersions) {
    expect_failure("later.msh", replaced(version4, "4.1", "4.2"), ":2", "MSH version '4.2' is not supported");
    expect_failure("parametric.msh", replaced(version2, "$Nodes", "$ParametricNodes"), ":8",
                   "$ParametricNodes");
}

TEST(GmshAscii, BadNumbers) {
    expect_failure("nan2.msh", replaced(version2, "0 0 1.5", "0 0 nan"), ":13",
                   "coordinate z 'nan' is not finite");
    expect_failure("inf4.msh", replaced(version4, "0 0 1.5", "0 inf 1.5"), ":18", "'inf' is not finite");
    expect_failure("index2.msh", replaced(version2, "5 4 3 2", "5 4 9 2"), ":21", "node 9 is not in $Nodes");
    expect_failure("negative2.msh", replaced(version2, "5 4 3 2", "5 4 -3 2"), ":21",
                   "node -3 is not in $Nodes");
    expect_failure("index4.msh", replaced(version4, "50 60 20 10", "50 60 20 11"), ":29",
                   "node 11 is not in $Nodes");
    expect_failure("twice4.msh", replaced(version4, "\n40\n", "\n50\n"), ":20", "node 50 occurs twice");
    expect_failure("size.msh", replaced(version2, "2.2 0 8", "2.2 0 4"), ":2", "the data size is not 8");
}

TEST(GmshAscii, BadCounts) {
    expect_failure("nodes2.msh", replaced(version2, "\n6\n1 0", "\n123456\n1 0"), ":9",
                   "123456 nodes announced");
    expect_failure("cells2.msh", replaced(version2, "\n3\n1 2 2", "\n12345\n1 2 2"), ":18",
                   "12345 elements announced");
    expect_failure("nodes4.msh", replaced(version4, "3 6 10 60", "3 99999 10 60"), ":5",
                   "99999 nodes announced");
    expect_failure("block4.msh", replaced(version4, "2 1 0 2", "2 1 0 99999"), ":6", "99999 nodes announced");
    expect_failure("cells4.msh", replaced(version4, "3 2 4 1", "3 2 4 88888"), ":28",
                   "88888 elements announced");
    expect_failure("sum4.msh", replaced(version4, "3 3 1 3", "3 2 1 3"), ":29", "the blocks have 3 elements");
}

TEST(GmshAscii, BadStructure) {
    expect_failure("cut2.msh", version2.substr(0, version2.find("3 4 3 1")) + "3 4 3", ":21",
                   "the file ends before");
    expect_failure("open2.msh", replaced(version2, "$EndNodes", ""), ":17", "$EndNodes is missing");
    expect_failure("open4.msh", replaced(version4, "$EndSurface", ""), ":31",
                   "section '$Surface' has no end");
    expect_failure("early.msh", "$Nodes\n0\n$EndNodes\n", ":1", "$Nodes comes before $MeshFormat");
    expect_failure("stray.msh", replaced(version2, "$Elements", "Elements"), ":17",
                   "expected a section such as");
    expect_failure("other.msh", "solid\n", ": ", "unknown format; bring it to .vtu with 'tandem convert");
    expect_failure("flat.msh", version2.substr(0, version2.find("$Elements")), ": ", "no tetrahedra");
}

} // namespace
} // namespace tandem::loader
