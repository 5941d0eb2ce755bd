// SPDX-License-Identifier: MIT
// Flawed tetrahedra of frames: counted, named, refused or skipped.
#include "harness/flaws.h"
#include "scenes/error.h"
#include "tests/support/flawed.h"

#include <gmock/gmock.h>

namespace tandem {
namespace {

using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string refusal(const Scene& scene, std::vector<Frame> frames, Degenerate handling) {
    try {
        handle_flaws(scene, 20, frames, handling);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

/// Bodies 0 and 1 rigid with one mesh, whose tetrahedra 3 and 5 are flat; body 2 deformable.
Scene scene_with_flat_mesh() {
    auto scene = boxes_scene(3, 2);
    make_flat(scene.meshes[0], scene.meshes[0].vertices, 3);
    make_flat(scene.meshes[0], scene.meshes[0].vertices, 5);
    return scene;
}

std::vector<std::uint32_t> flat_ones(const Mesh& mesh, const std::vector<Eigen::Vector3d>& vertices) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (is_flat(mesh, vertices, t)) result.push_back(t);
    return result;
}

TEST(Flaws, OfRigidBodiesAreThoseOfTheirMeshInEveryFrame) {
    const auto scene = scene_with_flat_mesh();
    const auto flat = flat_ones(scene.meshes[0], scene.meshes[0].vertices);
    ASSERT_GE(flat.size(), 2u);
    std::vector<Frame> frames{scene.frame(0), scene.frame(1)};
    const auto before = frames[0].deformed;
    const auto flaws = handle_flaws(scene, 20, frames, Degenerate::flat);
    EXPECT_EQ(flaws.degenerate, 4 * flat.size());
    EXPECT_EQ(flaws.non_finite, 0u);
    ASSERT_EQ(flaws.bodies.size(), 2u);
    EXPECT_EQ(flaws.bodies[1].body, 1u);
    EXPECT_EQ(flaws.bodies[1].degenerate, 2 * flat.size());
    EXPECT_EQ(flaws.bodies[1].frame, 20u);
    EXPECT_EQ(flaws.bodies[1].first.front(), flat.front());
    EXPECT_THAT(frames[0].skipped, IsEmpty());
    EXPECT_EQ(frames[0].deformed, before);
    handle_flaws(scene, 20, frames, Degenerate::skip);
    EXPECT_THAT(frames[1].skipped, ElementsAre(flat, flat, IsEmpty()));
}

TEST(Flaws, OfDeformableBodiesAreThoseOfEachFrame) {
    const auto scene = boxes_scene(3, 2);
    std::vector<Frame> frames{scene.frame(0), scene.frame(1), scene.frame(2)};
    const auto& mesh = scene.meshes[1];
    make_flat(mesh, frames[1].deformed[2], 7);
    const auto flat = flat_ones(mesh, frames[1].deformed[2]);
    const auto corner = mesh.tetrahedra[11][2];
    frames[2].deformed[2][corner].y() = -std::numeric_limits<double>::infinity();
    const auto bad = around(mesh, corner);
    const auto flaws = handle_flaws(scene, 0, frames, Degenerate::skip);
    EXPECT_EQ(flaws.degenerate, flat.size());
    EXPECT_EQ(flaws.non_finite, bad.size());
    ASSERT_EQ(flaws.bodies.size(), 1u);
    EXPECT_EQ(flaws.bodies[0].body, 2u);
    EXPECT_EQ(flaws.bodies[0].frame, 1u);
    EXPECT_EQ(flaws.bodies[0].first.front(), flat.front());
    EXPECT_THAT(frames[0].skipped, IsEmpty());
    EXPECT_THAT(frames[1].skipped, ElementsAre(IsEmpty(), IsEmpty(), flat));
    EXPECT_THAT(frames[2].skipped, ElementsAre(IsEmpty(), IsEmpty(), bad));
    for (const auto& v : frames[2].deformed[2]) EXPECT_TRUE(v.allFinite());
}

/// More than one stretch, found on several cores: still in order.
TEST(Flaws, OfLargeMeshesAreInOrder) {
    const auto scene = boxes_scene(12, 1); // 10368 tetrahedra
    std::vector<Frame> frames{scene.frame(0)};
    const auto& mesh = scene.meshes[1];
    for (const std::uint32_t t : {9000u, 4095u, 4096u, 17u}) make_flat(mesh, frames[0].deformed[2], t);
    const auto flat = flat_ones(mesh, frames[0].deformed[2]);
    const auto flaws = handle_flaws(scene, 0, frames, Degenerate::skip);
    EXPECT_EQ(flaws.degenerate, flat.size());
    EXPECT_EQ(frames[0].skipped[2], flat);
    EXPECT_EQ(flaws.bodies[0].first, std::vector<std::uint32_t>(flat.begin(), flat.begin() + 4));
}

TEST(Flaws, APoseThatIsNotFiniteLeavesOutTheBody) {
    const auto scene = boxes_scene(2, 1);
    std::vector<Frame> frames{scene.frame(0)};
    frames[0].poses[1].rotation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(scene, frames, Degenerate::flat),
                HasSubstr("48 not finite in 1 of 3 bodies: body 1 tetrahedron 0, 1, 2, 3, ... in frame 20"));
    const auto flaws = handle_flaws(scene, 0, frames, Degenerate::skip);
    EXPECT_EQ(flaws.non_finite, scene.meshes[0].tetrahedra.size());
    ASSERT_EQ(frames[0].skipped.size(), 3u);
    EXPECT_EQ(frames[0].skipped[1].size(), scene.meshes[0].tetrahedra.size());
    EXPECT_TRUE(frames[0].poses[1].rotation.coeffs().allFinite());
}

TEST(Flaws, RefusalsSayWhatAndWhere) {
    const auto scene = boxes_scene(2, 1);
    std::vector<Frame> frames{scene.frame(0)};
    EXPECT_EQ(refusal(scene, frames, Degenerate::reject), "no error");
    make_flat(scene.meshes[1], frames[0].deformed[2], 30);
    EXPECT_EQ(refusal(scene, frames, Degenerate::flat), "no error");
    EXPECT_THAT(
        refusal(scene, frames, Degenerate::reject),
        testing::ContainsRegex("--degenerate reject: tetrahedra [0-9]+ of zero volume in 1 of 3 bodies: "
                               "body 2 tetrahedron .*30.* in frame 20; "));
    const auto corner = scene.meshes[1].tetrahedra[9][0];
    frames[0].deformed[2][corner].x() = std::numeric_limits<double>::quiet_NaN();
    const auto text = refusal(scene, frames, Degenerate::flat);
    EXPECT_THAT(text, HasSubstr(" not finite in 1 of 3 bodies: body 2 tetrahedron "));
    EXPECT_THAT(text, testing::Not(HasSubstr("zero volume"))) << "they are no reason to refuse";
    EXPECT_THAT(refusal(scene, frames, Degenerate::reject), HasSubstr(" of zero volume and "));
}

TEST(Flaws, HandlingsHaveNames) {
    for (const auto handling : {Degenerate::flat, Degenerate::skip, Degenerate::reject})
        EXPECT_EQ(degenerate_named(std::string(name_of(handling))), handling);
    EXPECT_THROW(degenerate_named("keep"), InputError);
}

} // namespace
} // namespace tandem
