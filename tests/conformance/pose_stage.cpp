// SPDX-License-Identifier: MIT
// Poses of frames in the host's memory, packed by a kernel: the bits that the host packs.
#include "algorithms/bodies/origin.h"
#include "algorithms/bodies/pose_stage.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;

class PoseStages : public OnDevice {
protected:
    /// A stage where the device has one.
    std::unique_ptr<PoseStage> stage(const Bodies& bodies) const { return PoseStage::make(bodies, {32, 3}); }

    Scene scene = procession(400, 3, 0.35);
};

/// Quaternions of any length, and numbers that are not finite, as the host packs them.
TEST_P(PoseStages, PackTheBitsOfTheHost) {
    if (GetParam() == "host") {
        EXPECT_EQ(stage(Bodies(on, scene, {}, Bodies::Sharing::by_mesh)), nullptr);
        return;
    }
    auto frame = scene.frame(2);
    for (std::size_t i = 2; i < frame.poses.size(); ++i)
        frame.poses[i].rotation.coeffs() *= 0.01 * static_cast<double>(i);
    frame.poses[7].translation.x() = 1e300;
    for (const auto precision : {Precision::fp32, Precision::fp64}) {
        const Bodies bodies(on, scene, {.precision = precision}, Bodies::Sharing::by_mesh);
        const auto packing = stage(bodies);
        ASSERT_NE(packing, nullptr);
        packing->launch(frame, true);
        const auto right = bodies.packed_poses(frame);
        std::vector<std::byte> packed(right.size());
        {
            const StageScope scope(on, Stage::read);
            on.download(bodies.poses(), packed);
        }
        EXPECT_EQ(packed, right);
    }
    on.finish();
}

TEST_P(PoseStages, LeaveToTheHostWhatItPacksFasterOrAlone) {
    const Bodies exact(on, scene, {.placement = Placement::exact}, Bodies::Sharing::by_mesh);
    EXPECT_EQ(stage(exact), nullptr);
    const Bodies unshared(on, scene, {}, Bodies::Sharing::none);
    EXPECT_EQ(stage(unshared), nullptr);
    const auto few = procession(20, 1, 0);
    EXPECT_EQ(stage(Bodies(on, few, {}, Bodies::Sharing::by_mesh)), nullptr);
}

/// Frames, resets and subdomains of a session with many bodies.
TEST_P(PoseStages, GiveSessionsTheRightAnswer) {
    for (const std::string precision : {"float", "double"}) {
        const auto& traversal = algorithm("tiled");
        const auto session =
            prepare_on(on, traversal, scene, {{"broad", "device"}, {"precision", precision}});
        for (const std::size_t i : {0u, 1u, 2u, 0u}) {
            if (i == 2) session->reset();
            const auto frame = scene.frame(i);
            const auto right = reference(scene, frame, geometry_of(session->settings()), true, Method::sweep);
            const auto result = session->run(frame);
            expect_same_digests(result, right);
        }
    }
}

TEST_P(PoseStages, CentreDistantMeshes) {
    const auto distant = with_distant_meshes(scene, {1e6});
    const auto& traversal = algorithm("tiled");
    const auto session = prepare_on(on, traversal, distant, {{"broad", "device"}, {"origin", "auto"}});
    for (const std::size_t i : {0u, 2u}) {
        const auto frame = distant.frame(i);
        const auto right = reference(distant, counted_from(session->origin(), frame),
                                     geometry_of(session->settings()), true, Method::sweep);
        const auto result = session->run(frame);
        EXPECT_GT(result.count, 10000u);
        expect_same_digests(result, right);
    }
}

TANDEM_ON_DEVICES(PoseStages);

} // namespace
} // namespace tandem
