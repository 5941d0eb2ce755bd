// SPDX-License-Identifier: MIT
// Scenes in which no pair can be found in any frame, and why.
#include "algorithms/bodies/nothing_meets.h"
#include "algorithms/bodies/self_pairs.h"
#include "base/random.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

TEST(NothingMeets, WhereThereIsOneBody) {
    Scene scene;
    scene.bodies = {{}};
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::off).find("one body, which setting self=off"),
              std::string::npos);
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::deformable).find("self=deformable"), std::string::npos);
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::on), "");
    scene.bodies[0].deformable = true;
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::deformable), "");
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::off), "");
    scene.never_meet = {{0, 0}};
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::on).find("never_meet"), std::string::npos);
    scene.bodies.push_back({});
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::off), "");
}

TEST(NothingMeets, WhereAllBodiesAreFixed) {
    Scene scene;
    scene.bodies.assign(3, {.fixed = true});
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::on).find("all bodies are fixed"), std::string::npos);
    scene.bodies[1].fixed = false;
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::off), "");
}

/// Random filters, of which many leave no pair, against a test of every pair.
TEST(NothingMeets, AsAllPairsOfBodiesSay) {
    Random random(11);
    int apart = 0;
    for (int round = 0; round < 400; ++round) {
        Scene scene;
        const auto bodies = static_cast<std::uint32_t>(1 + random.next() % 6);
        for (std::uint32_t body = 0; body < bodies; ++body)
            scene.bodies.push_back({.fixed = random.next() % 2 == 0,
                                    .deformable = random.next() % 2 == 0,
                                    .groups = 1u << random.next() % 3,
                                    .meets = 1u << random.next() % 3});
        for (std::uint32_t a = 0; a < bodies; ++a)
            for (std::uint32_t b = a; b < bodies; ++b)
                for (auto times = random.next() % 3; times > 0; --times) scene.never_meet.push_back({a, b});
        for (const auto self : {SelfPairs::off, SelfPairs::deformable, SelfPairs::on}) {
            bool meets = false;
            for (std::uint32_t a = 0; a < bodies; ++a) {
                meets |= meets_itself(scene, a, self);
                for (std::uint32_t b = a + 1; b < bodies; ++b) meets |= may_meet(scene, a, b);
            }
            EXPECT_EQ(why_nothing_meets(scene, self).empty(), meets);
            apart += meets ? 0 : 1;
        }
    }
    EXPECT_GT(apart, 100);
    EXPECT_LT(apart, 1100);
}

/// Every pair of bodies once would take minutes.
TEST(NothingMeets, InLargeScenesToo) {
    Scene scene;
    scene.bodies.assign(300000, {.meets = 2});
    EXPECT_NE(why_nothing_meets(scene, SelfPairs::off), "");
    scene.bodies[7] = {.groups = 3};
    EXPECT_EQ(why_nothing_meets(scene, SelfPairs::off).empty(), may_meet(scene, 7, 8));
}

} // namespace
} // namespace tandem
