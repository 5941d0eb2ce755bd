// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "base/error.h"
#include "scenes/read/read.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace tandem::loader {

namespace {

std::string message(const std::string& path) {
    try {
        read_mesh(path);
        return "no error";
    } catch (const InputError& error) {
        return error.what();
    }
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
