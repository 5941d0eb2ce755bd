// SPDX-License-Identifier: MIT
// Setting margin: by every algorithm, the pairs of the reference; and no pair within the distance is missed,
// measured in double from the scene's own vertices.
#include "tests/support/distances.h"
#include "tests/support/frames_there.h"
#include "tests/support/long_form.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

/// The pairs of a frame that are apart and within `margin`. Some that meet may be among them.
std::vector<Pair> pairs_within(const Scene& scene, const Frame& frame, double margin) {
    std::vector<std::vector<FourCorners>> all(scene.bodies.size());
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body)
        for (std::uint32_t i = 0; i < scene.meshes[scene.bodies[body].mesh].tetrahedra.size(); ++i)
            all[body].push_back(corners_of(scene, frame, body, i));
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < all.size(); ++a)
        for (std::uint32_t b = a + 1; b < all.size(); ++b)
            for (std::uint32_t i = 0; i < all[a].size(); ++i)
                for (std::uint32_t j = 0; j < all[b].size(); ++j)
                    if (!are_beyond(all[a][i], all[b][j], margin)
                        && distance_between(all[a][i], all[b][j]) <= margin)
                        pairs.push_back({a, i, b, j});
    return pairs;
}

/// Those of `pairs` that are not among `found`.
std::vector<Pair> missing(std::vector<Pair> pairs, std::vector<Pair> found) {
    std::ranges::sort(pairs);
    std::ranges::sort(found);
    std::vector<Pair> result;
    std::ranges::set_difference(pairs, found, std::back_inserter(result));
    return result;
}

/// Two unit tetrahedra whose nearest points are `distance` apart along a direction.
Scene two_apart(const Eigen::Vector3d& direction, double distance, const Eigen::Vector3d& place) {
    Scene scene;
    scene.name = scene.key = "two";
    Mesh first = one_tetrahedron(1), second = first;
    // Each has a face, an edge or a corner at its end along the direction.
    const auto end = [&](const Mesh& mesh, double sign) {
        double most = -1e300;
        Eigen::Vector3d at;
        for (const auto& v : mesh.vertices)
            if (const double along = sign * direction.dot(v); along > most) most = along, at = v;
        return at;
    };
    const Eigen::Vector3d from = end(first, 1), to = end(second, -1);
    for (auto& v : first.vertices) v += place - from;
    for (auto& v : second.vertices) v += place - to + direction.normalized() * distance;
    scene.meshes = {first, second};
    scene.bodies = {{.mesh = 0}, {.mesh = 1}};
    for (auto& mesh : scene.meshes) complete_mesh(mesh, "one");
    scene.frame_count = 1;
    scene.frame = [](std::size_t) {
        Frame frame;
        frame.poses.resize(2);
        frame.deformed.resize(2);
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

class MarginOf : public OnDevice {
protected:
    Scene scene_ = crowd(21, 8, 2);
    Frame frame_ = scene_.frame(0);
};

TEST_P(MarginOf, EveryAlgorithmFindsThePairsOfTheReferenceAndMissesNone) {
    std::vector<SettingTexts> cells{{{"broad", "device"}}, {{"broad", "device"}, {"slabs", "three"}}};
    if (walks().size() > 2) {
        cells.push_back({{"broad", "tight"}, {"k", "8"}, {"precision", "double"}});
        cells.push_back({{"broad", "sphere"}, {"k", "26"}, {"pair_layout", "items"}});
        cells.push_back({{"broad", "sphere_boxes"}, {"k", "14"}, {"contact_rule", "sat"}});
        cells.push_back({{"broad", "device"}, {"placement", "exact"}, {"k", "6"}});
        cells.push_back({{"broad", "device"}, {"origin", "auto"}, {"self", "deformable"}});
    }
    for (const double margin : {0.02, 0.3}) {
        const auto within = pairs_within(scene_, frame_, margin * (1 - 1e-5)); // vertices are rounded
        ASSERT_GT(within.size(), 1000u);
        for (const auto* traversal : walks())
            for (auto given : cells) {
                if (given.contains("slabs") && !declares(*traversal, "slabs")) continue;
                given["margin"] = fmt::format("{}", margin);
                SCOPED_TRACE(std::string(traversal->name()) + text(given));
                const auto session = prepare(*traversal, scene_, given);
                const auto right = reference(scene_, frame_, geometry_of(session->settings()), true,
                                             Method::brute_force, contact_settings_of(session->settings()));
                const auto result = session->run(frame_);
                EXPECT_EQ(result.digest(), right.digest);
                EXPECT_EQ(result.contact_digest(), right.contact_digest);
                if (given.contains("contact_rule")) continue; // makes no pairs but those with boundary faces
                EXPECT_TRUE(missing(within, result.download()).empty());
            }
    }
}

/// Both tetrahedra end along the direction with corners, so that bounds have nothing to spare but roundings.
TEST_P(MarginOf, FindsAPairAtTheDistanceInAllDirections) {
    const auto& traversal = algorithm(GetParam() == "host" ? "chunked" : "tiled");
    for (const auto& place :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, -0.7, 3), Eigen::Vector3d(800, 5, -90)})
        for (const auto& direction : directions({.k = 26})) {
            const Eigen::Vector3d along(direction[0], direction[1], direction[2]);
            for (const double sign : {1.0, -1.0}) {
                const auto scene = two_apart(sign * along, 0.25, place);
                const auto found = [&](double margin) {
                    return prepare(
                               traversal, scene,
                               {{"k", "26"}, {"placement", "exact"}, {"margin", fmt::format("{}", margin)}})
                        ->run(scene.frame(0))
                        .count;
                };
                EXPECT_EQ(found(0.25), 1u) << along.transpose() << " at " << place.transpose();
                EXPECT_EQ(found(0.24), 0u) << along.transpose() << " at " << place.transpose();
            }
            if (!long_form() && GetParam() != "host") break; // sessions take long to prepare
        }
}

/// Pairs within the margin at a time between two frames.
TEST_P(MarginOf, HoldsBetweenFramesWithMotion) {
    const auto next = scene_.frame(1);
    const auto& traversal = algorithm("tiled");
    const auto session =
        prepare(traversal, scene_, {{"margin", "0.05"}, {"motion", "linear"}, {"contact_rule", "none"}});
    const auto result = session->run({frame_, next});
    const auto right = reference(scene_, {frame_, &next}, geometry_of(session->settings()), true,
                                 Method::brute_force, contact_settings_of(session->settings()));
    EXPECT_EQ(result.digest(), right.digest);
    for (const double s : {0.0, 0.3, 0.5, 1.0}) {
        Frame between = frame_;
        for (std::size_t body = 0; body < frame_.poses.size(); ++body) {
            const auto &from = frame_.poses[body], &to = next.poses[body];
            between.poses[body] = {from.rotation.slerp(s, to.rotation),
                                   (1 - s) * from.translation + s * to.translation};
            for (std::size_t i = 0; i < frame_.deformed[body].size(); ++i)
                between.deformed[body][i] = (1 - s) * frame_.deformed[body][i] + s * next.deformed[body][i];
        }
        EXPECT_TRUE(missing(pairs_within(scene_, between, 0.05 * (1 - 1e-4)), result.download()).empty())
            << s;
    }
}

/// A row of boxes with gaps: each is within the margin of its neighbours, so that body pairs grow, too.
TEST_P(MarginOf, BodiesApartArePairsForEveryBroadPhaseAndSeveralDevices) {
    const auto scene = procession(12, 2, 0.02);
    const auto frame = scene.frame(1);
    auto apart = frame;
    for (std::size_t body = 0; body < apart.poses.size(); ++body)
        apart.poses[body].translation.x() += 3.0 * static_cast<double>(body);
    const auto& tiled = algorithm("tiled");
    for (const std::string broad : {"device", "tight", "sphere", "sphere_boxes"}) {
        const auto settings = resolved(tiled, {{"broad", broad}, {"margin", "3.5"}});
        const auto one = prepare_on(on, tiled, scene, settings)->run(apart);
        EXPECT_GT(one.count, prepare(tiled, scene, {{"broad", broad}})->run(apart).count + 1000) << broad;
        const std::array both{&device("host"), &device("opencl:0")};
        if (broad == "sphere_boxes") continue;
        EXPECT_EQ(tiled.prepare(both, scene, settings)->run(apart).digest(), one.digest()) << broad;
    }
}

TEST_P(MarginOf, AZeroMarginIsNone) {
    for (const auto* traversal : walks()) {
        const auto none = prepare(*traversal, scene_)->run(frame_);
        EXPECT_EQ(prepare(*traversal, scene_, {{"margin", "0"}})->run(frame_).digest(), none.digest());
        EXPECT_EQ(prepare(*traversal, scene_, {{"margin", "-0"}})->run(frame_).digest(), none.digest());
        EXPECT_GT(prepare(*traversal, scene_, {{"margin", "1e-3"}})->run(frame_).count, none.count);
    }
}

TEST_P(MarginOf, ImpossibleValuesAreRefused) {
    const auto& chunked = algorithm("chunked");
    const auto refusal = [&](const SettingTexts& given) {
        return message_of([&] { prepare(chunked, scene_, given); });
    };
    for (const std::string value : {"-0.1", "inf", "nan", "1e31", "0.1m", ""})
        EXPECT_THAT(refusal({{"margin", value}}), HasSubstr("give a length from 0 to 1e+30")) << value;
    EXPECT_THAT(refusal({{"margin", "0.1"}, {"rounding", "published"}}),
                HasSubstr("margin does not go with rounding=published"));
    EXPECT_THAT(refusal({{"margin", "0.1"}, {"residency", "published"}, {"broad", "sphere"}}),
                HasSubstr("margin does not go with residency=published"));
}

TANDEM_ON_DEVICES(MarginOf);

} // namespace
} // namespace tandem
