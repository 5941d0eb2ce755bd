// SPDX-License-Identifier: MIT
// What of a scene a page has, and in which form.
#include "harness/report/base64.h"
#include "harness/report/interned.h"
#include "harness/report/quantised.h"
#include "harness/report/scene_data.h"
#include "scenes/scene.h"

#include <gmock/gmock.h>
#include <numeric>

namespace tandem::report {
namespace {

using testing::HasSubstr;

SceneSizes pile(std::size_t bodies, std::size_t frames) {
    return {.meshes = {{1000, 2000, bodies, 0}}, .bodies = bodies, .frames = frames};
}

TEST(ReportScene, SmallScenesAreWhole) {
    const auto shown = cut(pile(10, 50), {});
    EXPECT_EQ(shown.boxed, std::vector{false});
    EXPECT_EQ(shown.bodies, 10u);
    EXPECT_EQ(shown.frames, 50u);
}

TEST(ReportScene, ManyBodiesBecomeBoxesThenFewer) {
    const SceneBudget budget;
    const auto many = cut(pile(10'000, 3), budget);
    EXPECT_EQ(many.boxed, std::vector{true});
    EXPECT_EQ(many.bodies, 10'000u);
    const auto too_many = cut(pile(1'000'000, 3), budget);
    EXPECT_LT(too_many.bodies, 60'000u);
    EXPECT_GT(too_many.bodies, 10'000u);
    EXPECT_GE(too_many.frames, 1u);
}

TEST(ReportScene, TheLargestMeshBecomesBoxesFirst) {
    const SceneSizes sizes{.meshes = {{100, 200, 1, 0}, {400'000, 800'000, 1, 0}}, .bodies = 2, .frames = 1};
    EXPECT_EQ(cut(sizes, {}).boxed, (std::vector{false, true}));
}

TEST(ReportScene, FramesAreFewerWhereContactsWantRoom) {
    auto sizes = pile(1000, 1000);
    const auto without = cut(sizes, {});
    sizes.contacts = true;
    const auto with = cut(sizes, {});
    EXPECT_LT(without.frames, 1000u);
    EXPECT_LT(with.frames, without.frames);
    EXPECT_EQ(without.contacts, 0u);
    EXPECT_GT(with.contacts, 0u);
}

TEST(ReportScene, EveryCutFitsItsBudget) {
    const SceneBudget budget;
    for (const std::size_t bodies : {1u, 100u, 5'000u, 300'000u})
        for (const std::size_t deformable : {0u, 1u, 50u})
            for (const std::size_t frames : {1u, 10u, 100'000u}) {
                const SceneSizes sizes{.meshes = {{2000, 4000, bodies, std::min(deformable, bodies)}},
                                       .bodies = bodies,
                                       .frames = frames,
                                       .contacts = true};
                const auto shown = cut(sizes, budget);
                const auto vertices = shown.boxed[0] ? 8 : 2000;
                const auto bytes = mesh_bytes(2000, 4000)
                                   + shown.frames
                                         * (shown.bodies * 14 + std::min(deformable, bodies) * vertices * 6
                                            + shown.contacts * 9);
                EXPECT_LE(bytes, budget.bytes + budget.bytes / 4)
                    << bodies << ' ' << deformable << ' ' << frames;
            }
}

TEST(ReportScene, Base64IsThatOfTheStandard) {
    const auto of = [](std::string_view text) { return base64(std::as_bytes(std::span(text))); };
    EXPECT_EQ(of(""), "");
    EXPECT_EQ(of("f"), "Zg==");
    EXPECT_EQ(of("fo"), "Zm8=");
    EXPECT_EQ(of("foo"), "Zm9v");
    EXPECT_EQ(of("foobar"), "Zm9vYmFy");
    EXPECT_EQ(of("\xff\xfe\xfd"), "//79");
}

TEST(ReportScene, PointsKeepTheirPlaces) {
    const Quantised in(Eigen::AlignedBox3d(Eigen::Vector3d(-1, 0, 5), Eigen::Vector3d(1, 0, 9)));
    std::vector<std::uint16_t> numbers;
    in.add({-1, 0, 9}, numbers);
    in.add({0, 0, 6}, numbers);
    EXPECT_EQ(numbers, (std::vector<std::uint16_t>{0, 0, 65535, 32768, 0, 16384}));
}

TEST(ReportScene, SaysWhatIsLeftOut) {
    const auto scene = make_scene("plates:frames=200");
    std::vector<std::size_t> frames(200);
    std::iota(frames.begin(), frames.end(), 0);
    const auto whole = Json::parse(scene_data(scene, frames, nullptr, {}));
    EXPECT_EQ(whole["frames"].size(), 200u);
    EXPECT_TRUE(whole["notes"].empty());
    const auto less = Json::parse(scene_data(scene, frames, nullptr, {.bytes = 80'000}));
    EXPECT_LT(less["frames"].size(), 200u);
    EXPECT_EQ(less["frames"].front(), 0);
    EXPECT_EQ(less["frames"].back(), 199);
    EXPECT_EQ(less["poses"].size(), less["frames"].size());
    EXPECT_THAT(less["notes"].dump(), HasSubstr("of 200 frames are shown, evenly taken"));
}

} // namespace
} // namespace tandem::report
