// SPDX-License-Identifier: MIT
#include "scenes/export/surfaces.h"
#include "scenes/export/vtk.h"
#include "scenes/motion.h"
#include "base/base64.h"
#include "tests/support/folder.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

#include <zlib.h>

namespace tandem {
namespace {

using namespace support;
using testing::ElementsAre;
using testing::HasSubstr;

/// The numbers of one array, decoded according to VTK's manual of the format.
template<class T>
std::vector<T> array_of(const std::string& file, const std::string& name) {
    const auto tag = file.find("Name=\"" + name + "\"");
    EXPECT_NE(tag, std::string::npos) << name;
    const auto text = std::string_view(file).substr(file.find('>', tag) + 1);
    const auto words = [&](std::size_t count) {
        const auto bytes = *base64::decode(text, count * 8);
        std::vector<std::uint64_t> result(count);
        std::memcpy(result.data(), bytes.data(), count * 8);
        return result;
    };
    const auto header = words(3 + words(1)[0]);
    std::size_t stored = 0;
    for (std::size_t i = 3; i < header.size(); ++i) stored += header[i];
    const auto data = base64::decode(text, header.size() * 8 + stored)->substr(header.size() * 8);
    std::string bytes;
    for (std::size_t i = 3, at = 0; i < header.size(); at += header[i++]) {
        std::string part(i + 1 == header.size() && header[2] > 0 ? header[2] : header[1], '\0');
        uLongf size = part.size();
        EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(part.data()), &size,
                             reinterpret_cast<const Bytef*>(data.data()) + at, header[i]),
                  Z_OK);
        EXPECT_EQ(size, part.size());
        bytes += part;
    }
    std::vector<T> values(bytes.size() / sizeof(T));
    bytes.copy(reinterpret_cast<char*>(values.data()), bytes.size());
    return values;
}

class ExportVtk : public FolderTest {};

Eigen::Vector3d through_float(const Eigen::Vector3d& v) { return v.cast<float>().cast<double>(); }

TEST_F(ExportVtk, BodiesRoundTrip) {
    const auto scene = crowd(5, 6, 3);
    const auto frame = scene.frame(1);
    const auto cells = tetrahedron_count(scene);
    std::vector<std::uint32_t> chunk(cells);
    for (std::uint32_t i = 0; i < cells; ++i) chunk[i] = i * 3;
    const CellNumbers numbers{"chunk", chunk};
    write_vtu(path("f.vtu"), scene, frame, {&numbers, 1});
    const auto mesh = read_mesh(path("f.vtu"));
    ASSERT_EQ(mesh.vertices.size(), vertex_count(scene));
    ASSERT_EQ(mesh.tetrahedra.size(), cells);
    std::uint32_t vertex = 0, cell = 0;
    std::vector<std::uint32_t> bodies, tetrahedra;
    for (std::uint32_t b = 0; b < 6; ++b) {
        const auto& own = scene.meshes[scene.bodies[b].mesh];
        for (const auto& t : own.tetrahedra) {
            for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(mesh.tetrahedra[cell][i], t[i] + vertex);
            bodies.push_back(b);
            tetrahedra.push_back(static_cast<std::uint32_t>(&t - own.tetrahedra.data()));
            ++cell;
        }
        for (std::size_t v = 0; v < own.vertices.size(); ++v)
            EXPECT_EQ(mesh.vertices[vertex++],
                      through_float(b == 1 ? frame.deformed[1][v]
                                           : Eigen::Vector3d(rotated(frame.poses[b].rotation, own.vertices[v])
                                                             + frame.poses[b].translation)));
    }
    const auto file = bytes_of(path("f.vtu"));
    EXPECT_EQ(array_of<std::uint32_t>(file, "body"), bodies);
    EXPECT_EQ(array_of<std::uint32_t>(file, "tetrahedron"), tetrahedra);
    EXPECT_EQ(array_of<std::uint32_t>(file, "chunk"), chunk);
}

TEST_F(ExportVtk, PressuresRoundTrip) {
    auto scene = crowd(5, 6, 3);
    for (auto& mesh : scene.meshes) mesh.pressures.clear();
    write_vtu(path("none.vtu"), scene, scene.frame(0));
    EXPECT_TRUE(read_mesh(path("none.vtu")).pressures.empty());
    for (auto& mesh : scene.meshes)
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            mesh.pressures.push_back(1e7 / (3.0 + static_cast<double>(v)));
    write_vtu(path("all.vtu"), scene, scene.frame(1));
    std::vector<double> expected;
    for (const auto& body : scene.bodies)
        for (const double pressure : scene.meshes[body.mesh].pressures) expected.push_back(pressure);
    EXPECT_EQ(read_mesh(path("all.vtu")).pressures, expected);
    scene.meshes[0].pressures.clear();
    write_vtu(path("some.vtu"), scene, scene.frame(1));
    EXPECT_TRUE(read_mesh(path("some.vtu")).pressures.empty());
}

TEST_F(ExportVtk, LongArraysAreWrittenInBlocks) {
    auto scene = crowd(5, 2, 3);
    Mesh& mesh = scene.meshes[0];
    for (int i = 0; i < 60000; ++i) mesh.tetrahedra.push_back(mesh.tetrahedra[0]);
    mesh.tetrahedra.resize(32768); // connectivity fills exactly one block; with body 1 it is slightly larger
    scene.bodies.resize(1);
    write_vtu(path("one.vtu"), scene, scene.frame(0));
    EXPECT_EQ(array_of<std::int64_t>(bytes_of(path("one.vtu")), "connectivity").size(), 131072u);
    EXPECT_EQ(read_mesh(path("one.vtu")).tetrahedra, mesh.tetrahedra);
    mesh.tetrahedra.push_back({3, 2, 1, 0});
    write_vtu(path("two.vtu"), scene, scene.frame(0));
    EXPECT_EQ(read_mesh(path("two.vtu")).tetrahedra, mesh.tetrahedra);
}

TEST_F(ExportVtk, Contacts) {
    const std::vector<ContactPoint> contacts{{{0, 7, 1, 9}, 3, {1, 2, 3.5}, {0, 0, 1}, -0.25, 0},
                                             {{2, 4294967295u, 5, 6}, 15, {-1, 0.1, 0}, {1, 0, 0}, 0, 0}};
    write_contacts_vtp(path("c.vtp"), contacts);
    const auto file = bytes_of(path("c.vtp"));
    EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"2\" NumberOfVerts=\"2\""));
    EXPECT_THAT(array_of<float>(file, "Points"), ElementsAre(1, 2, 3.5f, -1, 0.1f, 0));
    EXPECT_THAT(array_of<float>(file, "normal"), ElementsAre(0, 0, 1, 1, 0, 0));
    EXPECT_THAT(array_of<float>(file, "depth"), ElementsAre(-0.25f, 0));
    EXPECT_THAT(array_of<std::uint32_t>(file, "body_a"), ElementsAre(0, 2));
    EXPECT_THAT(array_of<std::uint32_t>(file, "tet_a"), ElementsAre(7, 4294967295u));
    EXPECT_THAT(array_of<std::uint32_t>(file, "body_b"), ElementsAre(1, 5));
    EXPECT_THAT(array_of<std::uint32_t>(file, "tet_b"), ElementsAre(9, 6));
    EXPECT_THAT(array_of<std::uint32_t>(file, "feature"), ElementsAre(3, 15));
    EXPECT_THAT(array_of<std::int64_t>(file, "connectivity"), ElementsAre(0, 1));
    EXPECT_THAT(array_of<std::int64_t>(file, "offsets"), ElementsAre(1, 2));
    write_contacts_vtp(path("none.vtp"), {});
    EXPECT_THAT(array_of<float>(bytes_of(path("none.vtp")), "Points"), ElementsAre());
}

TEST_F(ExportVtk, Surfaces) {
    SurfaceFrames all;
    const std::vector<ContactPoint> rows{{{0, 7, 1, 9}, 3, {1, 2, 3}, {0, 0, 1}, 0.5, 2}};
    all.add(4, rows, {{{0, 0, 3}, {1, 0, 3}, {0, 1, 3}}, {1, 2, 3}, {3}});
    all.add(6, rows, {{{0, 0, 4}, {1, 0, 4}, {1, 1, 4}, {0, 1, 4}}, {4, 5, 6, 7}, {4}});
    const auto file = surfaces_vtp(all);
    EXPECT_THAT(file, HasSubstr("NumberOfPoints=\"7\""));
    EXPECT_THAT(file, HasSubstr("NumberOfPolys=\"2\""));
    const auto points = array_of<double>(file, "Points");
    EXPECT_EQ(std::vector(points.begin() + 9, points.begin() + 15), (std::vector<double>{0, 0, 4, 1, 0, 4}));
    EXPECT_THAT(array_of<std::int64_t>(file, "connectivity"), ElementsAre(0, 1, 2, 3, 4, 5, 6));
    EXPECT_THAT(array_of<std::int64_t>(file, "offsets"), ElementsAre(3, 7));
    EXPECT_THAT(array_of<double>(file, "pressure"), ElementsAre(1, 2, 3, 4, 5, 6, 7));
    EXPECT_THAT(array_of<double>(file, "normal"), ElementsAre(0, 0, 1, 0, 0, 1));
    EXPECT_THAT(array_of<double>(file, "area"), ElementsAre(0.5, 0.5));
    EXPECT_THAT(array_of<std::uint32_t>(file, "frame"), ElementsAre(4, 6));
    EXPECT_THAT(array_of<std::uint32_t>(file, "tet_b"), ElementsAre(9, 9));
}

TEST_F(ExportVtk, Collection) {
    write_pvd(path("a.pvd"), std::vector<TimedFile>{{0.5, "x.vtu"}, {1, "y.vtu"}});
    EXPECT_EQ(bytes_of(path("a.pvd")),
              "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
              "<Collection>\n<DataSet timestep=\"0.5\" part=\"0\" file=\"x.vtu\"/>\n"
              "<DataSet timestep=\"1\" part=\"0\" file=\"y.vtu\"/>\n"
              "</Collection>\n</VTKFile>\n");
    EXPECT_THAT(message_of([&] { write_pvd(path("no/folder.pvd"), {}); }),
                HasSubstr("no/folder.pvd: cannot be written"));
}

TEST(Base64, RoundTrips) {
    EXPECT_EQ(base64::encode("light work."), "bGlnaHQgd29yay4=");
    EXPECT_EQ(base64::encode("light work"), "bGlnaHQgd29yaw==");
    EXPECT_EQ(base64::encode("light wor"), "bGlnaHQgd29y");
    EXPECT_EQ(base64::encode("f"), "Zg==");
    EXPECT_EQ(base64::encode("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64::encode("\xff\xfe\xfd"), "//79");
    EXPECT_EQ(base64::encode(""), "");
    std::string bytes;
    for (int i = 0; i < 256; ++i) {
        bytes.push_back(static_cast<char>(255 - i));
        EXPECT_EQ(base64::decode(base64::encode(bytes), bytes.size()), bytes);
    }
}

} // namespace
} // namespace tandem
