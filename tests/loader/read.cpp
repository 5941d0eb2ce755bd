// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"
#include "base/error.h"
#include "scenes/read/read.h"

#include <sstream>

namespace tandem::loader {
namespace {

std::string message(const std::string& path) {
    return support::message_of([&] { read_mesh(path); });
}

TEST(Read, NotAFile) {
    EXPECT_EQ(message(folder() + "/none.msh"),
              folder() + "/none.msh: No such file or directory; check the path");
    EXPECT_EQ(message(folder() + "/none.ele"),
              folder() + "/none.ele: No such file or directory; check the path");
    EXPECT_EQ(message(folder()), folder() + ": is a folder; name a mesh file");
}

TEST(Read, UnknownFormat) {
    expect_failure("cube.stl", "solid cube\n", ": ", "unknown format");
    expect_failure("noise", std::string("\0\1\2\xff", 4), ": ", "unknown format");
    for (const std::string suffix : {".msh", ".mesh", ".veg", ".vtk", ".vtu"}) {
        expect_failure("empty" + suffix, "", ": ", "the file is empty");
        expect_failure("noise" + suffix, std::string("\0\1\2\n\xff", 5), "", "; ");
        expect_failure("blank" + suffix, " \n\n", "", "; ");
    }
}

/// One tetrahedron in every text format, with a byte-order mark, as some editors write it.
TEST(Read, AByteOrderMarkIsSkipped) {
    const std::string mark = "\xef\xbb\xbf", points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    write_file("marked.ele", mark + "1 4 0\n0 0 1 2 3\n");
    for (const auto& [name, text] :
         {std::pair<std::string, std::string>{
              "marked.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
                            "4 0 0 1\n$EndNodes\n$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n"},
          {"marked.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
                          "0 0 1 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n"},
          {"marked.veg", "*VERTICES\n4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n*ELEMENTS\nTET\n1 4 0\n"
                         "0 0 1 2 3\n"},
          {"marked.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
                             + points + "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"},
          {"marked.vtu",
           "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
           "<UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">\n<Points>"
           "<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">"
               + points
               + "</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" "
                 "format=\"ascii\">0 1 2 3</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" "
                 "format=\"ascii\">4</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">"
                 "10</DataArray></Cells>\n</Piece></UnstructuredGrid></VTKFile>\n"},
          {"marked.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n"}}) {
        SCOPED_TRACE(name);
        ASSERT_EQ(message(write_file(name, mark + text)), "no error");
        const auto mesh = read_mesh(folder() + "/" + name);
        EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
        EXPECT_EQ(mesh.vertices[3], Eigen::Vector3d(0, 0, 1));
    }
    expect_failure("utf16.vtk", std::string("\xff\xfe#\0 \0", 6), ": ", "format UTF-16 is not read");
}

TEST(Read, HalfAPair) { EXPECT_THROW(parse_mesh("1 3 0 0\n", "half.node"), InputError); }

/// Reads every mesh of a folder with a table manifest.tsv: file, origin, licence, vertices, tetrahedra, ...
TEST(Read, RealMeshes) {
    const char* meshes = std::getenv("TANDEM_MESHES");
    if (meshes == nullptr) GTEST_SKIP() << "Set TANDEM_MESHES to a folder of meshes with a manifest.tsv.";
    std::ifstream manifest(std::string(meshes) + "/manifest.tsv");
    ASSERT_TRUE(manifest) << meshes << " has no manifest.tsv";
    std::string line;
    std::getline(manifest, line);
    while (std::getline(manifest, line)) {
        std::istringstream row(line);
        std::string file, column, vertices, tetrahedra;
        std::getline(row, file, '\t');
        for (int skipped = 0; skipped < 2; ++skipped) std::getline(row, column, '\t');
        std::getline(row, vertices, '\t');
        std::getline(row, tetrahedra, '\t');
        const auto mesh = read_mesh(std::string(meshes) + "/" + file.substr(0, file.find('+')));
        EXPECT_EQ(std::to_string(mesh.vertices.size()), vertices) << file;
        EXPECT_EQ(std::to_string(mesh.tetrahedra.size()), tetrahedra) << file;
    }
}

} // namespace
} // namespace tandem::loader
