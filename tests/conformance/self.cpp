// SPDX-License-Identifier: MIT
// Setting self: pairs of tetrahedra of one body, by every algorithm, against brute force.
#include "tests/support/flawed.h"
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "algorithms/hierarchy/tile_trees.h"
#include "base/error.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

/// A box that is folded along x = 0, so that one half is inside the other, beside a rigid box with that shape
/// and a fixed one. The vertices move a little from frame to frame.
Scene folded_boxes(std::uint32_t cells) {
    Random random(cells);
    Scene scene;
    scene.name = scene.key = "folded boxes";
    auto mesh = shaken_box(cells, random);
    const auto rest = mesh.vertices;
    for (auto& v : mesh.vertices) v.x() = std::abs(v.x()) + 0.05 * v.y();
    complete_mesh(mesh, "folded box");
    scene.meshes = {mesh};
    scene.bodies = {{.mesh = 0, .fixed = true}, {.mesh = 0}, {.mesh = 0, .deformable = true}};
    scene.frame_count = 2;
    scene.frame = [rest](std::size_t index) {
        const double step = 0.01 * static_cast<double>(index);
        Frame frame;
        frame.poses = {{Eigen::Quaterniond::Identity(), {0.1, 0.9, 0.1}},
                       {Eigen::Quaterniond(0.8, 0.6, 0, 0), {0.2 + step, -0.7, 0}},
                       {}};
        frame.deformed.resize(3);
        for (const auto& v : rest)
            frame.deformed[2].push_back({std::abs(v.x()) + 0.1 * v.z() + step, v.y(), v.z() + 0.1 * v.x()});
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

ReferenceAnswer right_for(const Session& session, const Scene& scene, const Frame& frame,
                          Method method = Method::brute_force) {
    return reference(scene, frame, geometry_of(session.settings()), true, method,
                     contact_settings_of(session.settings()));
}

void expect_equal(const FrameResult& result, const ReferenceAnswer& right) {
    EXPECT_EQ(result.count, right.digest.count);
    expect_same_digests(result, right);
    EXPECT_EQ(result.download(), right.pairs);
    EXPECT_EQ(result.without_boundary, right.without_boundary);
    EXPECT_EQ(result.rejected, right.rejected);
}

class SelfPairsOf : public OnDevice {};

std::uint64_t of_body(const std::vector<Pair>& pairs, std::uint32_t body) {
    return static_cast<std::uint64_t>(std::ranges::count_if(
        pairs, [&](const Pair& pair) { return pair.body_a == body && pair.body_b == body; }));
}

/// Every broad phase finds the bodies, and every walk the pairs, with both layouts of pairs.
TEST_P(SelfPairsOf, EveryAlgorithmFindsThePairsOfTheReference) {
    const auto scene = folded_boxes(3);
    for (const auto* traversal : walks())
        for (const SettingTexts& given :
             {SettingTexts{{"self", "on"}, {"broad", "device"}},
              SettingTexts{{"self", "deformable"}, {"broad", "device"}, {"pair_layout", "items"}},
              SettingTexts{{"self", "on"}, {"broad", "tight"}, {"builder", "hilbert"}},
              SettingTexts{{"self", "deformable"}, {"broad", "sphere"}, {"output", "contacts"}}}) {
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto session = prepare(*traversal, scene, given);
            const bool is_on = given.at("self") == "on";
            for (std::size_t i = 0; i < scene.frame_count; ++i) {
                const auto frame = scene.frame(i);
                const auto right = right_for(*session, scene, frame);
                EXPECT_EQ(of_body(right.pairs, 0), 0u) << "a fixed body";
                EXPECT_EQ(of_body(right.pairs, 1) > 100, is_on);
                EXPECT_GT(of_body(right.pairs, 2), 100u);
                EXPECT_GT(right.contacts, 100u);
                expect_equal(session->run(frame), right);
            }
        }
}

/// What a pair of one body is: no common vertex, and the smaller number first. Independent of the reference.
TEST_P(SelfPairsOf, AreOrderedAndShareNoVertex) {
    const auto scene = folded_boxes(3);
    const auto& tetrahedra = scene.meshes.front().tetrahedra;
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto pairs = prepare(*traversal, scene, {{"self", "on"}})->run(scene.frame(0)).download();
        EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end()) << "a pair was found twice";
        for (const auto& pair : pairs) {
            if (pair.body_a != pair.body_b) continue;
            EXPECT_LT(pair.tet_a, pair.tet_b);
            for (const auto vertex : tetrahedra[pair.tet_a])
                EXPECT_EQ(std::ranges::count(tetrahedra[pair.tet_b], vertex), 0);
        }
    }
}

/// The sweep of the reference, with bodies of several chunks and tiles.
TEST_P(SelfPairsOf, LargerBodiesHaveThePairsOfASweep) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = folded_boxes(7);
    const auto frame = scene.frame(1);
    for (const auto* traversal : algorithms())
        for (const SettingTexts& more :
             {SettingTexts{}, SettingTexts{{"leaves", "4"}, {"seed_threshold", "1"}},
              SettingTexts{{"schedule", "item"}, {"descent", "both"}}, SettingTexts{{"most_seeds", "1"}},
              SettingTexts{{"slabs", "three"}}, SettingTexts{{"slabs", "all"}},
              SettingTexts{{"slabs", "touched"}}}) {
            if (!std::ranges::all_of(more, [&](const auto& one) { return declares(*traversal, one.first); }))
                continue;
            auto given = more;
            given["self"] = "on";
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto session = prepare(*traversal, scene, given);
            const auto right = right_for(*session, scene, frame, Method::sweep);
            ASSERT_GT(of_body(right.pairs, 1), 5000u);
            expect_equal(session->run(frame), right);
        }
}

/// Pairs of a body with itself make more body pairs than every two bodies, and repeated ones more than both.
/// Both lower the seed threshold of a body pair, so that pairs would be seeded above the levels that two
/// bodies need.
TEST_P(SelfPairsOf, MoreBodyPairsThanTwoBodiesFormAreWalked) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = folded_boxes(7);
    const auto frame = scene.frame(1);
    const std::array given{BodyPair{0, 1}, BodyPair{1, 1}, BodyPair{1, 2}, BodyPair{2, 2}};
    for (const auto* traversal : algorithms()) {
        if (!declares(*traversal, "seed_target")) continue;
        for (const std::string schedule : {"group", "item"})
            // Bodies have 515 chunks: three body pairs are seeded at level 0, and from four on above it.
            for (const std::string target : {"800000", "1000000", "2000000"}) {
                const SettingTexts settings{
                    {"self", "on"}, {"leaves", "4"}, {"seed_target", target}, {"schedule", schedule}};
                SCOPED_TRACE(std::string(traversal->name()) + text(settings));
                const auto session = prepare(*traversal, scene, settings);
                const auto right = right_for(*session, scene, frame, Method::sweep);
                expect_equal(session->run(frame), right);
                const auto once = session->run(frame, given);
                ASSERT_GT(once.count, 5000u);
                for (const std::size_t times : {2, 3, 9}) {
                    std::vector<BodyPair> repeated;
                    for (std::size_t i = 0; i < times; ++i)
                        repeated.insert(repeated.end(), given.begin(), given.end());
                    EXPECT_EQ(session->run(frame, repeated).count, times * once.count);
                }
            }
    }
}

/// One body has no pair of two bodies, but one with itself. It must not start with all pairs of its tiles of
/// level 0, which are more than 2^32 for two million tetrahedra.
TEST_P(SelfPairsOf, OneLargeBodyStartsWithFewPairsOfTiles) {
    auto scene = folded_boxes(11);
    scene.bodies = {{.mesh = 0}};
    const Bodies bodies(on, scene, {}, Bodies::Sharing::by_mesh);
    const std::uint32_t group_size = std::min(64u, on.info().max_group_size);
    const std::uint64_t tiles = (scene.meshes.front().tetrahedra.size() + 31) / 32; // 250
    for (const std::uint64_t most_seeds : {1u, 64u, 62499u, 62500u}) {
        SCOPED_TRACE(most_seeds);
        const TileTrees trees(bodies, Slabs::three, SelfPairs::on, group_size, most_seeds);
        const std::uint64_t begins = trees.begins(trees.walked_levels() - 1);
        EXPECT_LE(begins * begins, most_seeds);
        EXPECT_EQ(begins == tiles, most_seeds >= tiles * tiles);
    }
}

/// Less memory than the pairs need: batches, and windows of the one body's items.
TEST_P(SelfPairsOf, BatchesGiveTheSameAnswer) {
    const auto scene = folded_boxes(6);
    const auto frame = scene.frame(0);
    const BodyPair only{2, 2};
    for (const auto* traversal : walks())
        for (const std::string output : {"pairs", "digest"}) {
            if (!long_form() && GetParam() != "host" && output != "pairs") continue; // compilation takes long
            const SettingTexts given{{"self", "on"}, {"output", output}};
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            auto right = right_for(*prepare(*traversal, scene, given), scene, frame, Method::sweep);
            std::erase_if(right.pairs, [](const Pair& pair) { return pair.body_a != 2 || pair.body_b != 2; });
            ASSERT_GT(right.pairs.size(), 2000u);
            const Limited limit(on, least_bytes(on, *traversal, scene, given) + 8 * right.pairs.size());
            const auto session = prepare(*traversal, scene, given);
            const auto result = session->run(frame, {&only, 1});
            EXPECT_EQ(result.digest(), digest_of(right.pairs));
            if (output != "pairs") continue;
            EXPECT_GT(result.batches, 1u);
            EXPECT_EQ(result.download(), right.pairs);
        }
}

TEST_P(SelfPairsOf, SkippedTetrahedraAreInNoPair) {
    const auto scene = folded_boxes(3);
    auto frame = scene.frame(0);
    frame.skipped.resize(scene.bodies.size());
    for (std::uint32_t t = 0; t < 160; t += 3) frame.skipped[2].push_back(t);
    for (const auto* traversal : walks()) {
        SCOPED_TRACE(traversal->name());
        const auto session = prepare(*traversal, scene, {{"self", "deformable"}});
        const auto right = right_for(*session, scene, frame);
        ASSERT_GT(of_body(right.pairs, 2), 20u);
        expect_equal(session->run(frame), right);
    }
}

TEST_P(SelfPairsOf, AGivenPairOfOneBodyNeedsTheSetting) {
    const auto scene = folded_boxes(2);
    const BodyPair only{1, 1};
    const auto session = prepare(algorithm("tiled"), scene, {});
    EXPECT_THAT(message_of([&] {
                    session->run(scene.frame(0), {&only, 1});
                }),
                HasSubstr("a pair of body 1 with itself; set self=on"));
    EXPECT_GT(session->run(scene.frame(0)).body_pairs, 0u);
}

/// Two devices share the bodies: each pair of a body with itself belongs to one of them.
TEST(SharedSelfPairs, BelongToOneDevice) {
    const auto scene = folded_boxes(3);
    const std::array devices{&device("host"), &device("opencl:0")};
    for (const std::string broad : {"device", "tight"})
        for (const auto* traversal : walks(!long_form())) {
            SCOPED_TRACE(std::string(traversal->name()) + " " + broad);
            const auto session =
                traversal->prepare(devices, scene, resolved(*traversal, {{"self", "on"}, {"broad", broad}}));
            for (std::size_t i = 0; i < scene.frame_count; ++i)
                expect_equal(session->run(scene.frame(i)), right_for(*session, scene, scene.frame(i)));
        }
}

TANDEM_ON_DEVICES(SelfPairsOf);

} // namespace
} // namespace tandem
