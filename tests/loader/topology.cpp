// SPDX-License-Identifier: MIT
// Duplicates, welding, and cells that readers leave out or reduce.
#include "tests/loader/files.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"
#include "base/error.h"
#include "scenes/mesh.h"
#include "scenes/read/read.h"
#include "scenes/refine.h"
#include "scenes/scene.h"

#include <sstream>
#include <zlib.h>

namespace tandem::loader {
namespace {

/// The text of a Medit file.
std::string medit(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Tetrahedron>& tetrahedra) {
    auto text = fmt::format("MeshVersionFormatted 2 Dimension 3 Vertices {}\n", vertices.size());
    for (const auto& v : vertices) text += fmt::format("{} {} {} 0\n", v.x(), v.y(), v.z());
    text += fmt::format("Tetrahedra {}\n", tetrahedra.size());
    for (const auto& t : tetrahedra)
        text += fmt::format("{} {} {} {} 1\n", t[0] + 1, t[1] + 1, t[2] + 1, t[3] + 1);
    return text + "End\n";
}

const std::vector<Eigen::Vector3d> five{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
const std::vector<Tetrahedron> pair{{0, 1, 2, 3}, {4, 3, 2, 1}};

Mesh read(const std::string& text, const MeshReading& reading = {}) {
    return read_mesh(write_file("topology.mesh", text), reading);
}

TEST(Topology, DuplicatesInAnyOrderAreMerged) {
    const auto once = read(medit(five, pair));
    const auto mesh = read(medit(five, {pair[0], pair[1], {3, 1, 0, 2}, {1, 2, 3, 4}, {0, 1, 2, 3}}));
    EXPECT_EQ(mesh.merged, (std::vector<std::uint32_t>{2, 3, 4}));
    EXPECT_EQ(mesh.findings.duplicates, 3u);
    EXPECT_EQ(mesh.boundary, (std::vector<std::uint8_t>{once.boundary[0], once.boundary[1], 0, 0, 0}));
    EXPECT_EQ(once.boundary, (std::vector<std::uint8_t>{0b1110, 0b1110}));
    EXPECT_THAT(findings_text(mesh), testing::HasSubstr("3 tetrahedra have the vertices of an earlier one"));
    EXPECT_EQ(findings_text(once), "");
    EXPECT_DOUBLE_EQ(volume(mesh), volume(once));
    EXPECT_EQ(refined(mesh, 1).merged.size(), 24u);
    EXPECT_EQ(refined(mesh, 1).merged.front(), 16u);
}

TEST(Topology, KeptDuplicatesHaveTheBoundaryOfTheFirst) {
    const auto mesh = read(medit(five, {pair[0], pair[1], {3, 1, 0, 2}}), {.duplicates = Duplicates::keep});
    EXPECT_TRUE(mesh.merged.empty());
    EXPECT_EQ(mesh.boundary, (std::vector<std::uint8_t>{0b1110, 0b1110, 0b1011})); // vertex 0 is corner 2
}

TEST(Topology, DuplicatesAreRejected) {
    const auto mesh = medit(five, {pair[0], pair[1], {3, 1, 0, 2}});
    EXPECT_THAT(support::message_of([&] { read(mesh, {.duplicates = Duplicates::reject}); }),
                testing::HasSubstr("topology.mesh: 1 of 3 tetrahedra have the vertices of an "
                                   "earlier one, such as 2 those of 0"));
}

/// The pair without common vertex numbers: the second tetrahedron has copies, `off` beside.
std::string torn(double off) {
    auto vertices = five;
    for (const auto v : {1, 2, 3}) vertices.push_back(five[v] + Eigen::Vector3d(off, 0, 0));
    return medit(vertices, {pair[0], {4, 7, 6, 5}});
}

TEST(Topology, CoincidentVerticesAreFoundAndWelded) {
    const auto apart = read(torn(0));
    EXPECT_EQ(apart.findings.coincident, 3u);
    EXPECT_EQ(apart.boundary, (std::vector<std::uint8_t>{0b1111, 0b1111}));
    EXPECT_THAT(findings_text(apart), testing::HasSubstr("3 vertices lie where an earlier one lies"));
    const auto mesh = read(torn(0), {.weld = 0.0});
    EXPECT_EQ(mesh.boundary, (std::vector<std::uint8_t>{0b1110, 0b1110}));
    EXPECT_EQ(mesh.welded, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 1, 2, 3}));
    EXPECT_EQ(mesh.tetrahedra, apart.tetrahedra);
    EXPECT_EQ(mesh.vertices, apart.vertices);
    EXPECT_EQ(refined(mesh, 1).boundary, refined(read(medit(five, pair)), 1).boundary);
    EXPECT_EQ(refined(mesh, 1).welded.size(), refined(mesh, 1).vertices.size());
}

TEST(Topology, ToleranceBoundsWelding) {
    EXPECT_EQ(read(torn(0.125), {.weld = 0.124}).findings.welded, 0u);
    EXPECT_TRUE(read(torn(0.125), {.weld = 0.124}).welded.empty());
    EXPECT_EQ(read(torn(0.125), {.weld = 0.125}).findings.welded, 3u);
    EXPECT_EQ(read(torn(-0.125), {.weld = 0.125}).boundary, (std::vector<std::uint8_t>{0b1110, 0b1110}));
}

TEST(Topology, WeldedDuplicatesAreFound) {
    auto vertices = five;
    vertices.insert(vertices.end(), five.begin(), five.end());
    EXPECT_EQ(read(medit(vertices, {pair[0], {5, 6, 7, 8}})).findings.duplicates, 0u);
    const auto mesh = read(medit(vertices, {pair[0], {5, 6, 7, 8}}), {.weld = 0.0});
    EXPECT_EQ(mesh.merged, (std::vector<std::uint32_t>{1}));
}

constexpr auto second_order = R"(MeshVersionFormatted 2 Dimension 3 Vertices 10
0 0 0 0  1 0 0 0  0 1 0 0  0 0 1 0  .5 0 0 0  .5 .5 0 0  0 .5 0 0  0 0 .5 0  .5 0 .5 0  0 .5 .5 0
TetrahedraP2 1
1 2 3 4 5 6 7 8 9 10 1
Hexahedra 1
1 2 3 4 5 6 7 8 1
End
)";

TEST(Topology, CornersAndOnlyTetrahedra) {
    expect_failure("p2.mesh", second_order, ":3", "--corners");
    const auto no_hexahedra = replaced(second_order, "Hexahedra 1\n1 2 3 4 5 6 7 8 1\n", "");
    const auto mesh = read(no_hexahedra, {.corners = true});
    EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
    EXPECT_EQ(mesh.findings.reduced, 1u);
    EXPECT_THROW(read(second_order, {.corners = true}), InputError);
    EXPECT_EQ(read(second_order, {.corners = true, .only_tetrahedra = true}).findings.other_cells, 1u);
}

/// Gmsh writes orders 2 to 4, corners first.
TEST(Topology, MeditHasOrdersUpToFour) {
    const auto of_order = [](const std::string& order, std::size_t nodes) {
        std::string text = second_order;
        text.resize(text.find("TetrahedraP2"));
        text += "TetrahedraP" + order + " 2\n";
        for (const auto* corners : {"1 2 3 4 ", "2 3 4 5 "}) {
            text += corners;
            for (std::size_t i = 4; i < nodes; ++i) text += "9 ";
            text += "1\n";
        }
        return text + "End\n";
    };
    for (const auto& [order, nodes] : {std::pair{"2", 10u}, {"3", 20u}, {"4", 35u}}) {
        expect_failure("high.mesh", of_order(order, nodes), ":3", "--corners");
        const auto mesh = read(of_order(order, nodes), {.corners = true});
        EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 3, 4}})) << order;
        EXPECT_EQ(mesh.findings.reduced, 2u);
    }
    expect_failure("high.mesh", of_order("5", 56), ":3", "; convert to linear tetrahedra");
    EXPECT_THROW(read(of_order("5", 56), {.corners = true}), InputError);
}

constexpr auto gmsh_mixed =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
    "5 1 1 0\n6 1 0 1\n7 0 1 1\n8 1 1 1.5e-405\n$EndNodes\n$Elements\n2\n"
    "1 4 0 1 2 3 4\n2 5 0 1 2 5 3 4 6 8 7\n$EndElements\n";

TEST(Topology, GmshLeavesOutOtherCells) {
    expect_failure("mixed.msh", gmsh_mixed, ":", "--only-tetrahedra");
    const auto mesh = read_mesh(write_file("mixed.msh", gmsh_mixed), {.only_tetrahedra = true});
    EXPECT_EQ(mesh.tetrahedra.size(), 1u);
    EXPECT_EQ(mesh.findings.other_cells, 1u);
    EXPECT_EQ(mesh.vertices[7].z(), 0) << "a number that underflows";
    expect_failure("overflow.msh", replaced(gmsh_mixed, "1.5e-405", "1.5e405"), ":13", "is out of range");
}

TEST(Topology, GmshVersion1) {
    const std::string text = "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1\n$ENDNOD\n$ELM\n3\n"
                             "1 15 7 7 1 1\n2 4 7 7 4 1 2 3 4\n3 4 8 8 4 9 4 3 2\n$ENDELM\n";
    const auto mesh = read_mesh(write_file("one.msh", text));
    EXPECT_EQ(mesh.tetrahedra, pair);
    EXPECT_EQ(mesh.vertices, five);
    expect_failure("nodes.msh", replaced(text, "7 7 4 1", "7 7 3 1"), ":12", "has 4 nodes");
    expect_failure("end.msh", replaced(text, "$ENDNOD\n", ""), ":8", "$ENDNOD is missing");
}

/// Writes a text as gzip does, with `padding` zeros behind it. Returns the path.
std::string packed(const std::string& name, std::string_view text, std::size_t padding = 0) {
    const auto path = folder() + "/" + name;
    auto* file = gzopen(path.c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
    std::ofstream(path, std::ios::app | std::ios::binary) << std::string(padding, '\0');
    return path;
}

TEST(Topology, GzipIsUnpacked) {
    const auto path = packed("packed.mesh.gz", medit(five, pair), 3);
    const auto mesh = read_mesh(path);
    EXPECT_EQ(mesh.tetrahedra, pair);
    EXPECT_EQ(mesh.name, "packed");
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    EXPECT_EQ(parse_mesh(bytes.str(), "bytes.mesh").tetrahedra, pair);
    expect_failure("cut.mesh.gz", "\x1f\x8b\x08", ": ", "the gzip data are damaged");
    expect_failure("more.mesh.gz", bytes.str() + "x", ": ", "the gzip data are damaged");
}

TEST(Topology, EitherHalfOfTetGenMayBePacked) {
    const auto packed_node = packed("halves.node.gz", "5 3\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n");
    const auto plain_ele = write_file("halves.ele", "2 4\n0 0 1 2 3\n1 4 3 2 1\n");
    for (const auto& path : {packed_node, plain_ele}) {
        EXPECT_EQ(read_mesh(path).tetrahedra, pair) << path;
        EXPECT_EQ(read_mesh(path).name, "halves");
    }
}

/// The tolerance is in the unit of the scene, and meshes without a file are connected too.
TEST(Topology, DescriptionsWeldAfterTheirScale) {
    auto torn = five;
    torn.push_back({0, 0, 0.05});
    write_file("torn.mesh", medit(torn, {pair[0], {4, 3, 2, 5}}));
    const auto welded = [](const std::string& mesh, double tolerance) {
        const auto text =
            fmt::format(R"({{"meshes": {{"m": {}}}, "bodies": [{{"mesh": "m"}}], "frames": 1}})", mesh);
        return make_scene(write_file("scaled.json", text), {.weld = tolerance})
            .meshes.front()
            .findings.welded;
    };
    EXPECT_EQ(welded(R"({"file": "torn.mesh", "scale": 10})", 0.1), 0u);
    EXPECT_EQ(welded(R"({"file": "torn.mesh", "scale": 10})", 0.6), 1u);
    EXPECT_EQ(welded(R"({"file": "torn.mesh"})", 0.1), 1u);
    EXPECT_GT(welded(R"({"box": [1, 1, 1]})", 1.1), 0u);
}

/// A field of a file is kept through a scale, and one is made where the file has none.
TEST(Topology, DescriptionsHavePressures) {
    const auto read_field = [](const std::string& mesh, const MeshReading& reading) {
        const auto text =
            fmt::format(R"({{"meshes": {{"m": {}}}, "bodies": [{{"mesh": "m"}}], "frames": 1}})", mesh);
        return make_scene(write_file("fields.json", text), reading).meshes.front().pressures;
    };
    write_file("own.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n"
                          "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n"
                          "SCALARS pressure float\nLOOKUP_TABLE default\n0 1 2 3\n");
    const std::vector<double> own{0, 1, 2, 3};
    for (const auto* mesh : {R"({"file": "own.vtk"})", R"({"file": "own.vtk", "scale": 10})"}) {
        EXPECT_EQ(read_field(mesh, {}), own);
        EXPECT_EQ(read_field(mesh, {.pressure = 7}), own);
    }
    for (const auto* mesh : {R"({"box": [1, 1, 1]})", R"({"box": [1, 1, 1], "scale": 3})"}) {
        EXPECT_TRUE(read_field(mesh, {}).empty());
        EXPECT_EQ(read_field(mesh, {.pressure = 7}).back(), 7) << "the centre";
    }
}

TEST(Topology, FormatsWithoutAReaderAreNamed) {
    expect_failure("fluent.msh", "(0 \"Ansys Fluent\")\n(2 3)\n", ": ", "tandem convert");
    expect_failure("a.bdf", "$ Nastran\nBEGIN BULK\n", ": ", "tandem convert");
    expect_failure("a.unv", "    -1\n  2411\n", ": ", "I-deas UNV");
    expect_failure("a.feb", "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n", ": ", "FEBio");
    expect_failure("a.mesh", "MFEM mesh v1.0\n", ": ", "MFEM");
}

} // namespace
} // namespace tandem::loader
