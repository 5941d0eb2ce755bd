// SPDX-License-Identifier: MIT
// Candidate pairs by rounding and placement: which answers must be equal, which must not be compared, and
// whether kernels, reference and broad phase use the same slabs.
#include "algorithms/broad_phase/broad.h"
#include "algorithms/broad_phase/broad.h"
#include "harness/sampling/local_sampler.h"
#include "base/error.h"
#include "tests/support/cells.h"
#include "tests/support/leaf_slabs.h"
#include "tests/support/message_of.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;

/// The crowd moved away from the origin, where rounding matters.
Scene far_crowd(std::uint64_t seed, double offset) {
    auto scene = crowd(seed, 9, 1.0);
    scene.frame = [near = scene.frame, offset](std::size_t i) {
        auto frame = near(i);
        for (auto& pose : frame.poses) pose.translation.array() += offset;
        for (auto& body : frame.deformed)
            for (auto& v : body) v.array() += offset;
        frame.poses[1] = {}; // pose of the deformable body
        return frame;
    };
    return scene;
}

Measurement measured(const Scene& scene, References& references, const FrameRange& range,
                     const SettingTexts& given) {
    const auto& chunked = algorithm("chunked");
    const auto& preset = chunked.presets().front();
    const Cell cell{&chunked,
                    std::string(preset.name),
                    resolve(chunked.parameters(), preset.values, given, chunked.name()),
                    {&device("host")}};
    LocalSampler sampler(cell, scene, range, references);
    sampler.check({.count_work = false});
    sampler.round(1);
    return sampler.measurement();
}

TEST(BoundsAnswers, SafeAndNearestAgreeWithoutCornersAndEveryCellWithItsOwnReference) {
    const auto scene = far_crowd(81, 3000);
    const FrameRange range(scene, 0, 1);
    References references(scene, range);
    for (const int k : sanitized() ? std::vector{8, 18} : std::vector{8, 12, 18}) {
        std::map<std::string, Digest> digests;
        for (const std::string rounding : {"nearest", "safe", "published"}) {
            const auto found =
                measured(scene, references, range,
                         {{"k", std::to_string(k)}, {"rounding", rounding}, {"origin", "world"}});
            EXPECT_TRUE(found.agreement.ok()) << "k = " << k << " " << rounding;
            EXPECT_GT(found.agreement.digest.count, 100u);
            digests[rounding] = found.agreement.digest;
        }
        EXPECT_EQ(digests["nearest"] == digests["safe"], k != 8) << "k = " << k;
        EXPECT_NE(digests["published"], digests["safe"]) << "k = " << k;
    }
}

TEST(BoundsAnswers, ExactPlacementFindsMorePairs) {
    const auto scene = far_crowd(82, 1000);
    for (const auto precision : {Precision::fp32, Precision::fp64}) {
        const auto at = [&](Placement placement) {
            return reference(scene, scene.frame(0), {.precision = precision, .placement = placement}, false,
                             Method::brute_force)
                .pairs;
        };
        const auto lost = difference(at(Placement::rounded), at(Placement::exact));
        EXPECT_EQ(lost.missing, 0u);
        EXPECT_EQ(lost.extra > 0, precision == Precision::fp32);
    }
}

/// All pairs of tetrahedra that the kernels' leaf slabs do not separate.
template<class Real>
std::vector<Pair> kernel_pairs(const PairScene& scene, const Geometry& geometry) {
    const LeafSlabs<Real> slabs(device("host"), scene, geometry);
    const auto count = static_cast<std::uint32_t>(scene.scene().meshes[0].tetrahedra.size());
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < count; ++a)
        for (std::uint32_t b = 0; b < count; ++b)
            if (!slabs.separated(a, b)) pairs.push_back({0, a, 1, b});
    return pairs;
}

/// Directed sums have two implementations: the host dialect of the kernels computes exact sums, the reference
/// uses the processor's rounding modes.
TEST(BoundsAnswers, KernelsAndReferenceUseTheSameSlabsInEveryRounding) {
    SlabTouchMaker<float> maker(83, 300);
    std::vector<OraclePair> pairs;
    for (std::size_t i = 0; i < 150; ++i)
        pairs.push_back(maker.touching(directions({.k = 26})[i % 13], {1, -1, 0.5}));
    const Pose turned{Eigen::Quaterniond(0.9, 0.1, -0.3, 0.2), {0.1, 0.2, 0.3}};
    const PairScene in_world(pairs);
    const PairScene posed(pairs, {turned, turned});
    std::set<std::size_t> counts;
    for (const auto* scene : {&in_world, &posed})
        for (const auto rounding :
             {Rounding::nearest, Rounding::safe, Rounding::published, Rounding::directed})
            for (const auto placement : {Placement::rounded, Placement::exact}) {
                if (placement == Placement::exact
                    && (rounding == Rounding::nearest || rounding == Rounding::published))
                    continue;
                Geometry geometry{.k = 8, .rounding = rounding, .placement = placement};
                const auto in = [&] {
                    return reference(scene->scene(), scene->frame(), geometry, false, Method::brute_force)
                        .pairs;
                };
                const auto found = kernel_pairs<float>(*scene, geometry);
                EXPECT_EQ(found, in()) << static_cast<int>(rounding);
                counts.insert(found.size());
                geometry.precision = Precision::fp64;
                EXPECT_EQ(kernel_pairs<double>(*scene, geometry), in()) << static_cast<int>(rounding);
            }
    EXPECT_GT(counts.size(), 4u) << "equal answers of all roundings would test nothing";
}

TEST(BoundsAnswers, TheHostsBroadPhaseDropsNoBodyPairOfAnyBounds) {
    for (const double offset : {0.0, 1e3, 1e5}) {
        const auto scene = far_crowd(84, offset);
        const auto frame = scene.frame(0);
        for (const Geometry& geometry :
             {Geometry{.k = 8, .rounding = Rounding::published},
              Geometry{.k = 8, .placement = Placement::exact},
              Geometry{.k = 8, .rounding = Rounding::directed, .placement = Placement::exact}}) {
            const auto expected = reference(scene, frame, geometry, false, Method::brute_force).pairs;
            ASSERT_GT(expected.size(), 100u);
            for (const auto bound : {Broad::sphere, Broad::tight}) {
                const auto found = BroadSweep(scene, geometry, bound).pairs(frame);
                for (const auto& pair : expected)
                    ASSERT_TRUE(
                        std::binary_search(found.begin(), found.end(), BodyPair{pair.body_a, pair.body_b}));
            }
        }
    }
}

TEST(BoundsAnswers, DirectedIsRefusedWhereKernelsCannotRoundDirected) {
    const auto& chunked = algorithm("chunked");
    const auto settings = resolved(chunked, {{"rounding", "directed"}});
    auto info = device("opencl:0").info();
    EXPECT_THAT(message_of([&] { chunked.fitted(settings, info); }),
                HasSubstr("rounding=directed is impossible on opencl:0"));
    info.has_directed_rounding = true;
    EXPECT_EQ(algorithm("chunked").fitted(settings, info)[parameters::rounding], Rounding::directed);
}

} // namespace
} // namespace tandem
