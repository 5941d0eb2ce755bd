// SPDX-License-Identifier: MIT
// Rotations of scene descriptions.
#include "scenes/scene.h"
#include "tests/support/folder.h"
#include "tests/support/test.h"

#include <bit>

namespace tandem {
namespace {

class ScenesRotation : public support::FolderTest {};

/// The same four numbers give the same bits, as `rotation` or as `poses`, until the body turns. Each
/// normalisation may change the last bits, and two change those of these numbers.
TEST_F(ScenesRotation, HasTheBitsOfPoses) {
    for (const auto* q :
         {"0.07765293774064505, -0.027510828999840038, -0.4278700823561289, -0.2928281956712715",
          "1e-300, -0.0, 3e-301, 2e-305", "1e200, 1e200, -3e199, 1e150"}) {
        SCOPED_TRACE(q);
        support::write_bytes(path("scene.json"), fmt::format(R"({{"frames": 2,
            "meshes": {{"a": {{"box": [1, 1, 1]}}}}, "bodies": [{{"mesh": "a", "rotation": [{0}]}},
            {{"mesh": "a", "rotation": [{0}], "spin": [0, 0, 1, 1]}},
            {{"mesh": "a", "poses": [[0, 0, 0, {0}], [0, 0, 0, {0}]]}}]}})",
                                                             q));
        const auto scene = make_scene(path("scene.json"));
        const auto bits = [&](std::size_t frame, std::size_t body) {
            const auto rotation = scene.frame(frame).poses[body].rotation;
            return std::bit_cast<std::array<std::uint64_t, 4>>(
                std::array{rotation.w(), rotation.x(), rotation.y(), rotation.z()});
        };
        for (std::size_t body = 0; body < 3; ++body) EXPECT_EQ(bits(0, body), bits(0, 2)) << body;
        EXPECT_EQ(bits(1, 0), bits(1, 2));
        EXPECT_NE(bits(1, 1), bits(1, 2)) << "it turns";
        EXPECT_NEAR(scene.frame(0).poses[0].rotation.norm(), 1, 1e-15);
    }
}

} // namespace
} // namespace tandem
