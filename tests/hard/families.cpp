// SPDX-License-Identifier: MIT
// The catalogue: generators are correct and reproducible, and refuse impossible parameters.
#include "tests/hard/support.h"

#include "algorithms/bodies/range.h"
#include "harness/verify/oracle/frame_truth.h"
#include "base/error.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace hard_test;
using support::failure;
using testing::HasSubstr;

#ifdef TANDEM_SANITIZED
constexpr std::uint64_t tried = 48;
#else
constexpr std::uint64_t tried = 288;
#endif

std::string name_of(const HardFamily& family) { return "hard:" + std::string(family.name); }

std::array<double, 3> difficulties(const HardFamily& family) {
    return {family.knob.least, family.knob.initial, family.knob.most};
}

TEST(HardFamilies, AreTheWholeCatalogue) {
    const auto families = hard_families();
    ASSERT_EQ(families.size(), 59u);
    std::set<std::string_view> names;
    for (unsigned i = 0; i < families.size(); ++i) {
        const auto& family = families[i];
        SCOPED_TRACE(family.name);
        EXPECT_EQ(family.row, i + 1);
        EXPECT_TRUE(names.insert(family.name).second);
        EXPECT_NE(family.pair == nullptr, family.scene == nullptr);
        EXPECT_LT(family.knob.least, family.knob.most);
        EXPECT_NO_THROW(check_difficulty(family, family.knob.initial));
        EXPECT_EQ(family.self, family.group == 'g');
        EXPECT_EQ(family.motion, family.group == 'h');
        EXPECT_EQ(family.distant, family.group == 'i');
        for (const auto text : {family.summary, family.knob.meaning, family.metric, family.fails})
            EXPECT_FALSE(text.empty());
    }
    EXPECT_EQ(families.front().group, 'a');
    EXPECT_EQ(families.back().group, 'i');
    EXPECT_TRUE(std::is_sorted(families.begin(), families.end(),
                               [](const auto& p, const auto& q) { return p.group < q.group; }));
}

TEST(HardFamilies, MakePairsWithTheirKnownRelation) {
    for (const auto* family : pair_families(false)) {
        for (const double e : difficulties(*family)) {
            SCOPED_TRACE(testing::Message() << family->name << " " << e);
            std::uint64_t known = 0;
            for (std::uint64_t i = 0; i < tried; ++i) {
                const auto pair = hard_pair(*family, 5, i, e);
                ASSERT_TRUE(agrees(pair.known, relation_of(pair))) << "pair " << i;
                known += pair.known != Known::open ? 1 : 0;
            }
            if (family->truth == HardTruth::construction) {
                EXPECT_EQ(known, tried);
            }
        }
    }
}

/// Families of unknown truth must contain both answers, or they test little.
TEST(HardFamilies, FamiliesOfUnknownTruthContainBothAnswers) {
    for (const auto* family : pair_families(false)) {
        if (family->truth == HardTruth::construction || family->truth == HardTruth::geometry) continue;
        if (family->name == "collapsing") continue; // always touches
        std::uint64_t intersecting = 0;
        for (std::uint64_t i = 0; i < 2 * tried; ++i)
            intersecting += meets(relation_of(hard_pair(*family, 7, i, family->knob.initial))) ? 1 : 0;
        EXPECT_GT(intersecting, 0u) << family->name;
        EXPECT_LT(intersecting, 2 * tried) << family->name;
    }
}

TEST(HardFamilies, AreReproducibleAndDifferBySeed) {
    for (const auto& family : hard_families()) {
        if (family.pair == nullptr) continue;
        std::uint64_t equal = 0;
        for (std::uint64_t i = 16; i-- > 0;) {
            const auto pair = hard_pair(family, 1, i, family.knob.initial);
            const auto again = hard_pair(family, 1, i, family.knob.initial);
            EXPECT_EQ(std::memcmp(&pair, &again, sizeof pair.a + sizeof pair.b), 0) << family.name;
            const auto other = hard_pair(family, 2, i, family.knob.initial);
            equal += std::memcmp(&pair.a, &other.a, sizeof pair.a) == 0 ? 1 : 0;
        }
        EXPECT_LT(equal, 4u) << family.name;
    }
}

bool is_float(double x) {
    const volatile auto narrow = static_cast<float>(x);
    return static_cast<double>(narrow) == x || std::isnan(x);
}

bool all_floats(const std::vector<Eigen::Vector3d>& points) {
    return std::all_of(points.begin(), points.end(),
                       [](const auto& p) { return is_float(p.x()) && is_float(p.y()) && is_float(p.z()); });
}

TEST(HardScenes, HaveSinglePrecisionNumbersAndAStableDigest) {
    for (const auto& family : hard_families()) {
        SCOPED_TRACE(family.name);
        const auto scene = make_scene(name_of(family));
        EXPECT_EQ(scene.digest, make_scene(name_of(family)).digest);
        EXPECT_NE(scene.digest, make_scene(name_of(family) + ":seed=2").digest);
        if (family.distant) continue;
        for (const auto& mesh : scene.meshes) EXPECT_TRUE(all_floats(mesh.vertices));
        for (const std::size_t index : {std::size_t{0}, scene.frame_count - 1}) {
            const auto frame = scene.frame(index);
            EXPECT_EQ(frame.poses.size(), scene.bodies.size());
            for (const auto& vertices : frame.deformed) EXPECT_TRUE(all_floats(vertices));
        }
    }
}

TEST(HardScenes, ContainTheirPairs) {
    const auto scene = make_scene("hard:touch:pairs=12,together=3,seed=9,difficulty=5");
    EXPECT_EQ(scene.key, "hard:touch:difficulty=5,seed=9,pairs=12,together=3");
    ASSERT_EQ(scene.frame_count, 4u);
    const auto pair = hard_pair(hard_family("touch"), 9, 3 * 2 + 1, 5);
    const auto frame = scene.frame(2);
    for (unsigned i = 0; i < 4; ++i)
        for (unsigned axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(frame.deformed[0][4 + i][axis], static_cast<double>(pair.a[i][axis]));
            EXPECT_EQ(frame.deformed[1][4 + i][axis], static_cast<double>(pair.b[i][axis]));
        }
}

TEST(HardScenes, HaveTheConstructedNumberOfIntersections) {
    for (const auto& family : hard_families()) {
        if (family.scene == nullptr) continue;
        SCOPED_TRACE(family.name);
        if (family.motion) continue; // nothing meets in frame 0
        const auto scene = make_scene(name_of(family));
        const auto self = family.self ? SelfPairs::on : SelfPairs::off;
        const auto truth = rounded_truth(scene, origin_for(family), self);
        const auto intersecting = truth.touching.size() + truth.overlapping.size();
        EXPECT_GT(intersecting, 0u);
        if (family.meeting != nullptr) {
            EXPECT_EQ(intersecting, family.meeting(family.knob.initial));
        }
    }
}

TEST(HardScenes, OfRigidBodiesContainBothAnswers) {
    for (const auto* family : pair_families(true)) {
        const auto scene = make_scene(name_of(*family) + ":pairs=256,together=64");
        std::uint64_t intersecting = 0;
        for (std::size_t f = 0; f < scene.frame_count; ++f) {
            std::vector<Pair> intended;
            for (std::uint32_t t = 0; t < 64; ++t) intended.push_back({0, t, 1, t});
            for (const auto& decision : decide_pairs(scene, scene.frame(f), Precision::fp32, intended))
                intersecting += meets(decision.relation) ? 1 : 0;
        }
        EXPECT_GT(intersecting, 0u) << family->name;
        EXPECT_LT(intersecting, 256u) << family->name;
    }
}

TEST(HardScenes, RefuseImpossibleParameters) {
    EXPECT_THAT(failure("hard:tuch"),
                HasSubstr("unknown family of hard cases 'tuch'; the nearest is 'touch'"));
    EXPECT_THAT(failure("hard"), HasSubstr("hard:FAMILY"));
    EXPECT_THAT(failure("hard:touch:difficulty=20"),
                HasSubstr("hard:touch: difficulty=20 is impossible; give a number from 1 to 9"));
    EXPECT_THAT(failure("hard:touch:difficulty=nan"), HasSubstr("difficulty=nan is impossible"));
    EXPECT_THAT(failure("hard:touch:pairs=10,together=3"), HasSubstr("together=3 does not divide pairs=10"));
    EXPECT_THAT(failure("hard:all-overlap:pairs=10"), HasSubstr("pairs"));
    for (const auto& family : hard_families()) {
        EXPECT_THROW(check_difficulty(family, std::nextafter(family.knob.least, -1e300)), InputError);
        EXPECT_THROW(check_difficulty(family, std::nextafter(family.knob.most, 1e300)), InputError);
    }
}

std::string refusal(const Scene& scene, std::size_t frame) {
    return support::message_of([&] { check_range(scene, scene.frame(frame), Geometry{}); });
}

/// For every corner, infinite or not a number.
TEST(HardScenes, WithNonFiniteCoordinatesAreRefused) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        const auto scene =
            make_scene("hard:not-finite:pairs=9,together=1,difficulty=" + std::to_string(corner));
        const auto expected = "body " + std::to_string(corner / 4) + ": vertex " + std::to_string(corner % 4);
        for (std::size_t frame = 0; frame < 9; ++frame)
            EXPECT_THAT(refusal(scene, frame), HasSubstr(expected + " is not finite")) << frame;
    }
}

TEST(HardScenes, AllExpandsToEveryFamily) {
    const auto all = expand_hard("hard:all:pairs=8,seed=3");
    ASSERT_EQ(all.size(), 59u);
    EXPECT_EQ(all.front(), "hard:slab-touch:pairs=8,seed=3");
    EXPECT_EQ(all.back(), "hard:far:seed=3");
    EXPECT_EQ(expand_hard("hard:touch"), std::vector<std::string>{"hard:touch"});
    EXPECT_EQ(expand_hard("hard:all-overlap"), std::vector<std::string>{"hard:all-overlap"});
    EXPECT_THROW(expand_hard("hard:all:difficulty=1"), InputError);
}

} // namespace
} // namespace tandem
