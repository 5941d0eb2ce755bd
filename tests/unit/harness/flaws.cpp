// SPDX-License-Identifier: MIT
// Flawed tetrahedra of frames: counted, reported, refused or skipped.
#include "harness/frames/frames.h"
#include "base/error.h"
#include "tests/support/flawed.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string refusal(const Scene& whole, const std::vector<Frame>& frames, Degenerate handling) {
    const auto scene = with_frames(whole, frames, 20);
    return message_of([&] { FrameRange(scene, 20, 19 + frames.size(), handling); });
}

/// Bodies 0 and 1 are rigid and share a mesh, whose tetrahedra 3 and 5 are flat; body 2 is deformable.
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

TEST(Flaws, OfRigidBodiesComeFromTheirMeshInEveryFrame) {
    const auto whole = scene_with_flat_mesh();
    const auto flat = flat_ones(whole.meshes[0], whole.meshes[0].vertices);
    ASSERT_GE(flat.size(), 2u);
    const auto scene = with_frames(whole, {whole.frame(0), whole.frame(1)}, 20);
    const FrameRange range(scene, 20, 21);
    const auto& flaws = range.flaws();
    EXPECT_EQ(flaws.degenerate, 4 * flat.size());
    EXPECT_EQ(flaws.non_finite, 0u);
    ASSERT_EQ(flaws.bodies.size(), 2u);
    EXPECT_EQ(flaws.bodies[1].body, 1u);
    EXPECT_EQ(flaws.bodies[1].degenerate, 2 * flat.size());
    EXPECT_EQ(flaws.bodies[1].frame, 20u);
    EXPECT_EQ(flaws.bodies[1].first.front(), flat.front());
    EXPECT_THAT(range.frame(0)->skipped, IsEmpty());
    EXPECT_EQ(range.frame(0)->deformed, whole.frame(0).deformed);
    for (const auto budget : {std::uint64_t{0}, frame_budget}) {
        const FrameRange skipping(scene, 20, 21, Degenerate::skip, budget);
        EXPECT_THAT(skipping.frame(1)->skipped, ElementsAre(flat, flat, IsEmpty()));
    }
}

TEST(Flaws, OfDeformableBodiesComeFromEachFrame) {
    const auto whole = boxes_scene(3, 2);
    std::vector<Frame> frames{whole.frame(0), whole.frame(1), whole.frame(2)};
    const auto& mesh = whole.meshes[1];
    make_flat(mesh, frames[1].deformed[2], 7);
    const auto flat = flat_ones(mesh, frames[1].deformed[2]);
    const auto corner = mesh.tetrahedra[11][2];
    frames[2].deformed[2][corner].y() = -std::numeric_limits<double>::infinity();
    const auto bad = around(mesh, corner);
    const auto scene = with_frames(whole, frames);
    for (const auto budget : {std::uint64_t{0}, frame_budget}) {
        const FrameRange range(scene, 0, 2, Degenerate::skip, budget);
        const auto& flaws = range.flaws();
        EXPECT_EQ(flaws.degenerate, flat.size());
        EXPECT_EQ(flaws.non_finite, bad.size());
        ASSERT_EQ(flaws.bodies.size(), 1u);
        EXPECT_EQ(flaws.bodies[0].body, 2u);
        EXPECT_EQ(flaws.bodies[0].frame, 1u);
        EXPECT_EQ(flaws.bodies[0].first.front(), flat.front());
        EXPECT_THAT(range.frame(0)->skipped, IsEmpty());
        EXPECT_THAT(range.frame(1)->skipped, ElementsAre(IsEmpty(), IsEmpty(), flat));
        EXPECT_THAT(range.frame(2)->skipped, ElementsAre(IsEmpty(), IsEmpty(), bad));
        EXPECT_TRUE(std::ranges::all_of(range.frame(2)->deformed[2], [](auto& v) { return v.allFinite(); }));
    }
}

/// Several ranges, searched on several cores: the result is still in order.
TEST(Flaws, OfLargeMeshesAreInOrder) {
    const auto whole = boxes_scene(12, 1); // 10368 tetrahedra
    std::vector<Frame> frames{whole.frame(0)};
    const auto& mesh = whole.meshes[1];
    for (const std::uint32_t t : {9000u, 4095u, 4096u, 17u}) make_flat(mesh, frames[0].deformed[2], t);
    const auto flat = flat_ones(mesh, frames[0].deformed[2]);
    const auto scene = with_frames(whole, frames);
    const FrameRange range(scene, 0, 0, Degenerate::skip);
    EXPECT_EQ(range.flaws().degenerate, flat.size());
    EXPECT_EQ(range.frame(0)->skipped[2], flat);
    EXPECT_EQ(range.flaws().bodies[0].first, std::vector<std::uint32_t>(flat.begin(), flat.begin() + 4));
}

TEST(Flaws, APoseThatIsNotFiniteSkipsTheBody) {
    const auto whole = boxes_scene(2, 1);
    std::vector<Frame> frames{whole.frame(0)};
    frames[0].poses[1].rotation.x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(whole, frames, Degenerate::flat),
                HasSubstr("48 not finite in 1 of 3 bodies: body 1 tetrahedron 0, 1, 2, 3, ... in frame 20"));
    const auto scene = with_frames(whole, frames);
    const FrameRange range(scene, 0, 0, Degenerate::skip);
    EXPECT_EQ(range.flaws().non_finite, scene.meshes[0].tetrahedra.size());
    const auto frame = range.frame(0);
    ASSERT_EQ(frame->skipped.size(), 3u);
    EXPECT_EQ(frame->skipped[1].size(), scene.meshes[0].tetrahedra.size());
    EXPECT_TRUE(frame->poses[1].rotation.coeffs().allFinite());
}

TEST(Flaws, ErrorsReportTheFlawAndItsPosition) {
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
    EXPECT_THAT(text, testing::Not(HasSubstr("zero volume"))) << "flat tetrahedra are no reason for an error";
    EXPECT_THAT(refusal(scene, frames, Degenerate::reject), HasSubstr(" of zero volume and "));
}

TEST(Flaws, HandlingsHaveNames) {
    for (const auto handling : {Degenerate::flat, Degenerate::skip, Degenerate::reject})
        EXPECT_EQ(degenerate_named(std::string(name_of(handling))), handling);
    EXPECT_THROW(degenerate_named("keep"), InputError);
}

} // namespace
} // namespace tandem
