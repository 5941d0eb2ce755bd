// SPDX-License-Identifier: MIT
// Scenes of bodies with pressure fields of their own.
#include "scenes/pressure_field.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::ElementsAre;
using testing::HasSubstr;
using Vector = Eigen::Vector3d;

std::vector<ContactPoint> polygons_of(const Scene& scene, std::size_t step) {
    const auto session = prepare_on(device("host"), algorithm("tiled"), scene,
                                    texts("contact_rule=pressure precision=double"));
    return session->run(scene.frame(step)).download_contacts();
}

/// Whether the field is 0 on the boundary and `modulus` at most and somewhere within.
void expect_field(const Mesh& mesh, double modulus) {
    EXPECT_EQ(mesh.pressures.size(), mesh.vertices.size());
    EXPECT_EQ(most_pressure_on_boundary(mesh), 0);
    EXPECT_EQ(*std::ranges::max_element(mesh.pressures), modulus);
    EXPECT_EQ(mesh.inverted + mesh.degenerate, 0u);
}

TEST(ScenesSpheres, HintsAreThoseOfTheBenchmark) {
    const std::pair<const char*, std::uint64_t> sizes[] = {{"4", 2}, {"3", 3},    {"2", 4},
                                                           {"1", 8}, {"0.5", 16}, {"0.25", 32}};
    for (const auto& [hint, cells] : sizes) {
        SCOPED_TRACE(hint);
        const auto scene = make_scene(std::string("spheres:hint=") + hint);
        EXPECT_EQ(tetrahedron_count(scene), 2 * 6 * cells * cells * cells);
        for (const auto& mesh : scene.meshes) expect_field(mesh, 1e5);
    }
    EXPECT_EQ(make_scene("spheres:hint=1.0").key, make_scene("spheres").key);
}

TEST(ScenesSpheres, TheBallIsBesideTheEllipsoid) {
    const double places[] = {7, 4, 3.5, 1.2};
    for (std::size_t overlap = 0; overlap < 4; ++overlap) {
        const auto scene = make_scene("spheres:hint=4,overlap=" + std::to_string(overlap));
        const auto first = scene.frame(0), second = scene.frame(1);
        EXPECT_EQ(first.poses[0].translation, Vector::Zero());
        EXPECT_EQ(first.poses[1].translation, Vector::Constant(places[overlap]));
        EXPECT_NE(second.poses[1].translation, first.poses[1].translation);
        EXPECT_LT((second.poses[1].translation - first.poses[1].translation).norm(), 1e-2);
    }
    const auto scene = make_scene("spheres");
    for (const auto& v : scene.meshes[1].vertices) EXPECT_LT(v.norm(), 3 + 1e-14);
    EXPECT_EQ(scene.meshes[0].vertices.back(), -scene.meshes[0].vertices.front());
}

/// Drake's benchmark names them: no contact, boxes that overlap only, a minimal and an intermediate surface.
TEST(ScenesSpheres, OverlapsAreThoseOfTheBenchmark) {
    std::vector<std::size_t> polygons;
    for (const std::string overlap : {"0", "1", "2", "3"})
        polygons.push_back(polygons_of(make_scene("spheres:hint=1,overlap=" + overlap), 0).size());
    EXPECT_THAT(polygons, ElementsAre(0, 0, 487, 3013)) << "3013 as scripts/drake time has it";
}

TEST(ScenesSpheres, AFieldOfItsOwnIsKept) {
    MeshReading reading;
    reading.pressure = 1;
    const auto scene = make_scene("spheres:hint=4,refine=1", reading);
    for (const auto& mesh : scene.meshes) expect_field(mesh, 1e5);
    EXPECT_EQ(tetrahedron_count(scene), 2u * 8 * 48);
}

TEST(ScenesCompliant, SameOnEveryMachine) {
    EXPECT_EQ(make_scene("spheres").digest, 0x96bf84f81547c6e8u);
}

TEST(ScenesCompliant, ImpossibleParameters) {
    for (const auto* specification :
         {"spheres:hint=0", "spheres:hint=0.049", "spheres:hint=5", "spheres:hint=x", "spheres:overlap=4",
          "spheres:overlap=-1", "spheres:frames=0"})
        EXPECT_THAT(failure(specification), HasSubstr("give a number from")) << specification;
    EXPECT_THAT(failure("spheres:cells=3"), HasSubstr("parameter of scene spheres"));
}

} // namespace
} // namespace tandem
