// SPDX-License-Identifier: MIT
// output=wrenches: of each body pair the sums of its polygons, with equal bits under any order, capacity,
// limit of memory and number of devices, and close to sums in double.
#include "tests/support/limited.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;
using Vector = Eigen::Vector3d;

struct Wrench {
    Vector force = Vector::Zero(), torque = Vector::Zero();
    double area = 0, pressed = 0; ///< pressed: the sum of magnitudes
    std::size_t polygons = 0;
};

using Wrenches = std::map<std::pair<std::uint32_t, std::uint32_t>, Wrench>;

/// Sums of polygons in double, torques about `pivots` of bodies.
Wrenches sums_of(const std::vector<ContactPoint>& polygons, const std::vector<Vector>& pivots) {
    Wrenches sums;
    for (const auto& row : polygons) {
        auto& sum = sums[{row.pair.body_a, row.pair.body_b}];
        const Vector force = Vector(row.normal.data()) * row.depth * row.pressure;
        sum.force += force;
        sum.torque += (Vector(row.point.data()) - pivots[row.pair.body_a]).cross(force);
        sum.area += row.depth;
        sum.pressed += force.norm();
        ++sum.polygons;
    }
    return sums;
}

class WrenchesOf : public OnDevice {
protected:
    void expect_right(const Traversal& traversal, const Scene& scene, const SettingTexts& given) {
        SCOPED_TRACE(std::string(traversal.name()) + text(given));
        const auto frame = scene.frame(0);
        const auto session = prepare(traversal, scene, given);
        const auto right = reference(scene, frame, geometry_of(session->settings()), true,
                                     Method::brute_force, contact_settings_of(session->settings()));
        const auto result = session->run(frame);
        EXPECT_EQ(result.digest(), right.digest);
        EXPECT_EQ(result.contact_digest(), right.contact_digest);
        EXPECT_EQ(result.contacts, right.contacts);
        EXPECT_GT(result.contacts, 5u);
    }

    Scene scene_ = crowd(21, 8, 0.8);
};

TEST_P(WrenchesOf, EveryAlgorithmHasTheSumsOfTheReference) {
    std::vector<SettingTexts> cells{
        {{"output", "wrenches"}, {"contact_rule", "pressure"}, {"order", "canonical"}}};
    if (walks().size() > 2) {
        cells.push_back(
            {{"output", "wrenches"}, {"contact_rule", "pressure"}, {"precision", "double"}, {"k", "6"}});
        cells.push_back({{"output", "wrenches"},
                         {"contact_rule", "pressure"},
                         {"pair_layout", "items"},
                         {"broad", "device"}});
        cells.push_back({{"output", "wrenches"},
                         {"contact_rule", "pressure"},
                         {"group_size", "64"},
                         {"order", "canonical"},
                         {"contact_capacity", "1"},
                         {"pair_capacity", "1"}});
    }
    for (const auto* traversal : walks())
        for (const auto& cell : cells) expect_right(*traversal, scene_, cell);
}

TEST_P(WrenchesOf, TheyAreSumsOfPolygons) {
    const auto& tiled = algorithm("tiled");
    const auto frame = scene_.frame(1);
    std::vector<Vector> pivots;
    for (std::size_t body = 0; body < scene_.bodies.size(); ++body)
        pivots.push_back(scene_.bodies[body].deformable ? Vector::Zero() : frame.poses[body].translation);
    for (const std::string precision : {"float", "double"}) {
        const double allowed = precision == "float" ? 1e-5 : 1e-12;
        const SettingTexts given{{"precision", precision}, {"contact_rule", "pressure"}, {"origin", "world"}};
        const auto right = sums_of(prepare(tiled, scene_, given)->run(frame).download_contacts(), pivots);
        auto summing = given;
        summing["output"] = "wrenches";
        const auto rows = prepare(tiled, scene_, summing)->run(frame).download_contacts();
        ASSERT_EQ(rows.size(), right.size());
        for (const auto& row : rows) {
            const auto& sum = right.at({row.pair.body_a, row.pair.body_b});
            EXPECT_EQ(row.feature, sum.polygons);
            EXPECT_LT((Vector(row.point.data()) - sum.force).norm(), allowed * sum.pressed);
            // The unit of torques of a deformable body is 2^10 times its size.
            const bool deforms = scene_.bodies[row.pair.body_a].deformable;
            EXPECT_LT((Vector(row.normal.data()) - sum.torque).norm(),
                      (deforms ? 1000 : 4) * allowed * sum.pressed);
            EXPECT_NEAR(row.depth, sum.area, allowed * sum.area);
        }
    }
}

/// Powers of two in the unit of length and of pressure scale sums exactly.
TEST_P(WrenchesOf, UnitsScaleSums) {
    auto scaled = scene_;
    for (auto& mesh : scaled.meshes)
        for (double& pressure : mesh.pressures) pressure *= 0x1p40;
    const auto& tiled = algorithm("tiled");
    const SettingTexts given{{"output", "wrenches"}, {"contact_rule", "pressure"}};
    const auto rows = prepare(tiled, scene_, given)->run(scene_.frame(0)).download_contacts();
    const auto others = prepare(tiled, scaled, given)->run(scene_.frame(0)).download_contacts();
    ASSERT_EQ(rows.size(), others.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(rows[i].point[k] * 0x1p40, others[i].point[k]);
            EXPECT_EQ(rows[i].normal[k] * 0x1p40, others[i].normal[k]);
            EXPECT_EQ(rows[i].depth, others[i].depth);
        }
}

/// A scene and its frame 0 with lengths times 2^exponent.
std::pair<Scene, Frame> scaled(Scene scene, int exponent) {
    auto frame = scene.frame(0);
    const double unit = std::ldexp(1.0, exponent);
    for (auto& mesh : scene.meshes)
        for (auto& vertex : mesh.vertices) vertex *= unit;
    for (auto& pose : frame.poses) pose.translation *= unit;
    for (auto& body : frame.deformed)
        for (auto& vertex : body) vertex *= unit;
    return {std::move(scene), std::move(frame)};
}

/// In any unit of length, numbers are those of other units without a lost digit, or the frame is refused.
TEST_P(WrenchesOf, UnitsOfLengthScaleSumsOrAreRefused) {
    const auto& tiled = algorithm("tiled");
    for (const std::string output : {"contacts", "wrenches"}) {
        const SettingTexts given{{"output", output}, {"contact_rule", "pressure"}, {"order", "canonical"}};
        const auto rows = prepare(tiled, scene_, given)->run(scene_.frame(0)).download_contacts();
        const bool sums = output == "wrenches";
        std::map<int, std::string> refused;
        for (int exponent = -64; exponent <= 64; exponent += 4) {
            SCOPED_TRACE(fmt::format("{}, lengths times 2^{}", output, exponent));
            const auto [scene, frame] = scaled(scene_, exponent);
            std::vector<ContactPoint> others;
            const auto message =
                message_of([&] { others = prepare(tiled, scene, given)->run(frame).download_contacts(); });
            if (message != "no error") {
                refused[exponent] = message;
                continue;
            }
            ASSERT_EQ(rows.size(), others.size());
            for (std::size_t i = 0; i < rows.size(); ++i) {
                for (std::size_t k = 0; k < 3; ++k) {
                    EXPECT_EQ(std::ldexp(rows[i].point[k], sums ? 2 * exponent : exponent),
                              others[i].point[k]);
                    EXPECT_EQ(std::ldexp(rows[i].normal[k], sums ? 3 * exponent : 0), others[i].normal[k]);
                }
                EXPECT_EQ(std::ldexp(rows[i].depth, 2 * exponent), others[i].depth);
            }
        }
        EXPECT_FALSE(refused.contains(-32) || refused.contains(28)) << output;
        EXPECT_TRUE(refused.contains(-60) && refused.contains(64)) << output;
    }
}

TEST_P(WrenchesOf, BatchesHaveTheSameSums) {
    const auto scene = procession(12, 2, 0.02);
    const auto frame = scene.frame(1);
    std::size_t in_batches = 0;
    for (const std::string precision : {"float", "double"})
        for (const auto* traversal : walks()) {
            if (precision == "double" && traversal->name() != "tiled") continue;
            const SettingTexts given{{"output", "wrenches"},
                                     {"contact_rule", "pressure"},
                                     {"precision", precision},
                                     {"pair_capacity", "500"},
                                     {"contact_capacity", "50"}};
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const Answer right(prepare(*traversal, scene, given)->run(frame));
            const auto least = least_bytes(on, *traversal, scene, given);
            for (const double factor : {1.02, 1.05, 1.2, 1.5, 2.0}) {
                const Limited limited(on, static_cast<std::size_t>(factor * static_cast<double>(least)));
                try {
                    const auto session = prepare(*traversal, scene, given);
                    const auto result = session->run(frame);
                    in_batches += result.batches > 1 ? 1 : 0;
                    EXPECT_EQ(Answer(result), right) << factor;
                    EXPECT_EQ(Answer(session->run(frame)), right) << factor;
                } catch (const OutOfMemory&) {}
            }
        }
    EXPECT_GT(in_batches, 0u);
}

TEST_P(WrenchesOf, TwoDevicesHaveTheSameSums) {
    const auto scene = procession(12, 2, 0.02);
    const auto frame = scene.frame(1);
    const auto& tiled = algorithm("tiled");
    const auto settings = resolved(tiled, {{"output", "wrenches"}, {"contact_rule", "pressure"}});
    const auto one = prepare_on(on, tiled, scene, settings)->run(frame);
    ASSERT_EQ(one.contacts, 11u);
    const std::array both{&device("host"), &device("opencl:0")};
    const auto two = tiled.prepare(both, scene, settings)->run(frame);
    EXPECT_EQ(two.contacts, one.contacts);
    EXPECT_EQ(two.contact_digest(), one.contact_digest());
}

/// Torques are about the pose of a body, wherever its mesh's own origin and the world's are.
TEST_P(WrenchesOf, OfDistantMeshesAreAboutTheirPoses) {
    const auto scene = with_distant_meshes(scene_, {1000, 0, 300});
    const auto& tiled = algorithm("tiled");
    const SettingTexts given{
        {"output", "wrenches"}, {"contact_rule", "pressure"}, {"origin", "auto"}, {"precision", "double"}};
    const auto near = prepare(tiled, scene_, given)->run(scene_.frame(0)).download_contacts();
    const auto far = prepare(tiled, scene, given)->run(scene.frame(0)).download_contacts();
    ASSERT_EQ(near.size(), far.size());
    const auto frame = scene_.frame(0), moved = scene.frame(0);
    std::size_t rigid = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
        const auto a = near[i].pair.body_a;
        const Vector force(near[i].point.data());
        EXPECT_LT((Vector(far[i].point.data()) - force).norm(), 1e-9);
        if (scene.bodies[a].deformable) continue;
        ++rigid;
        const Vector by = frame.poses[a].translation - moved.poses[a].translation;
        EXPECT_LT((Vector(far[i].normal.data()) - (Vector(near[i].normal.data()) + by.cross(force))).norm(),
                  1e-8);
    }
    EXPECT_GT(rigid, 5u);
}

TEST_P(WrenchesOf, ImpossibleSettingsAndSizesAreRefused) {
    const auto& tiled = algorithm("tiled");
    EXPECT_THAT(message_of([&] {
                    prepare(tiled, scene_, {{"output", "wrenches"}, {"contact_rule", "sat"}});
                }),
                HasSubstr("output=wrenches needs contact_rule=pressure"));
    auto faint = scene_;
    for (auto& mesh : faint.meshes)
        for (double& pressure : mesh.pressures) pressure *= 0x1p-120;
    EXPECT_THAT(message_of([&] {
                    prepare(tiled, faint, {{"contact_rule", "pressure"}});
                }),
                HasSubstr("has pressures up to"));
    EXPECT_EQ(message_of([&] {
                  prepare(tiled, faint, {{"contact_rule", "pressure"}, {"precision", "double"}});
              }),
              "no error");
    const auto session = prepare(
        tiled, scene_,
        {{"output", "wrenches"}, {"contact_rule", "pressure"}, {"origin", "world"}, {"precision", "double"}});
    auto frame = scene_.frame(0);
    for (auto& pose : frame.poses) pose.translation += Vector::Constant(1e9);
    for (auto& vertex : frame.deformed[1]) vertex += Vector::Constant(1e9);
    EXPECT_THAT(message_of([&] { session->run(frame); }),
                HasSubstr("a polygon what its bodies' meshes let expect"))
        << "the deformable body is 2^28 times its size from the origin";
    EXPECT_EQ(session->run(scene_.frame(0)).contacts,
              prepare(tiled, scene_, {{"output", "wrenches"}, {"contact_rule", "pressure"}})
                  ->run(scene_.frame(0))
                  .contacts);
}

TANDEM_ON_DEVICES(WrenchesOf);

} // namespace
} // namespace tandem
