// SPDX-License-Identifier: MIT
// Scenes of bodies with pressure fields of their own: spheres and grippers.
#include "scenes/digest.h"
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

/// The rows of a frame: polygons, or sums with output=wrenches.
std::vector<ContactPoint> rows(const Scene& scene, std::size_t step, const std::string& output = "pairs") {
    const auto session = prepare_on(device("host"), algorithm("tiled"), scene,
                                    texts("contact_rule=pressure precision=double output=" + output));
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
        polygons.push_back(rows(make_scene("spheres:hint=1,overlap=" + overlap), 0).size());
    EXPECT_THAT(polygons, ElementsAre(0, 0, 487, 3013)) << "3013 as scripts/drake time has it";
}

TEST(ScenesSpheres, AFieldOfItsOwnIsKept) {
    MeshReading reading;
    reading.pressure = 1;
    const auto scene = make_scene("spheres:hint=4,refine=1", reading);
    for (const auto& mesh : scene.meshes) expect_field(mesh, 1e5);
    EXPECT_EQ(tetrahedron_count(scene), 2u * 8 * 48);
}

TEST(ScenesGrippers, WorldsShareTwoMeshes) {
    const auto scene = make_scene("grippers");
    EXPECT_EQ(scene.bodies.size(), 48u);
    EXPECT_EQ(scene.world_size, 3u);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(tetrahedron_count(make_scene("grippers:worlds=1")), 2u * 384 + 1296);
    EXPECT_EQ(make_scene("grippers:worlds=1").world_size, 0u);
    expect_field(scene.meshes[0], 1e5);
    expect_field(scene.meshes[1], 1e6);
    EXPECT_EQ(make_scene("grippers:worlds=1024").bodies.size(), 3072u);
    const auto frame = scene.frame(0);
    std::set<double> places;
    for (std::size_t object = 2; object < frame.poses.size(); object += 3) {
        places.insert(frame.poses[object].translation.x());
        EXPECT_LT(frame.poses[object].translation.norm(), 0.0052);
        EXPECT_EQ(scene.frame(7).poses[object].translation, frame.poses[object].translation);
    }
    EXPECT_EQ(places.size(), 16u) << "each world has another pose";
    EXPECT_NE(make_scene("grippers:seed=2").frame(0).poses[2].translation, frame.poses[2].translation);
}

TEST(ScenesGrippers, FingersCloseAndOpen) {
    const auto scene = make_scene("grippers:frames=21");
    EXPECT_TRUE(rows(scene, 0, "wrenches").empty());
    const auto closed = rows(scene, 10, "wrenches");
    ASSERT_EQ(closed.size(), 32u) << "two fingers in each world";
    for (const auto& row : closed) {
        EXPECT_EQ(row.pair.body_b % 3, 2u);
        EXPECT_EQ(row.pair.body_a / 3, row.pair.body_b / 3);
        const bool is_left = row.pair.body_a % 3 == 0;
        EXPECT_EQ(row.point[0] < 0, is_left) << "the force on a finger is away from the object";
        EXPECT_GT(row.feature, 20u);
    }
    EXPECT_EQ(digest_of(scene.frame(13)), digest_of(scene.frame(7)));
    EXPECT_EQ(digest_of(scene.frame(20)), digest_of(scene.frame(0)));
}

TEST(ScenesCompliant, SameOnEveryMachine) {
    EXPECT_EQ(make_scene("spheres").digest, 0x96bf84f81547c6e8u);
    EXPECT_EQ(make_scene("grippers").digest, 0x3ffff4573ea7abc3u);
}

TEST(ScenesCompliant, ImpossibleParameters) {
    for (const auto* specification :
         {"spheres:hint=0", "spheres:hint=0.049", "spheres:hint=5", "spheres:hint=x", "spheres:overlap=4",
          "spheres:overlap=-1", "spheres:frames=0", "grippers:worlds=0", "grippers:worlds=1.5",
          "grippers:frames=0", "grippers:seed=x"})
        EXPECT_THAT(failure(specification), HasSubstr("give a number from")) << specification;
    EXPECT_THAT(failure("spheres:cells=3"), HasSubstr("parameter of scene spheres"));
}

} // namespace
} // namespace tandem
