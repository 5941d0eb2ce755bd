// SPDX-License-Identifier: MIT
// The coordinate origin with origin=auto: a distant scene gives the same results as the same scene near the
// world's origin.
#include "algorithms/bodies/origin.h"
#include "harness/plans/frames.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"

#include <gtest/gtest.h>

namespace tandem {
namespace {

using namespace support;
using Vector = Eigen::Vector3d;

/// Multiples of 2^-20, which an added integer does not round.
Vector on_grid(const Vector& v) { return (v * 0x1p20).array().round() * 0x1p-20; }

/// A crowd moved by an integer vector.
Scene crowd_at(const Vector& offset) {
    auto scene = crowd(4, 9, 1);
    scene.frame = [near = scene.frame, offset](std::size_t i) {
        auto frame = near(i);
        for (std::size_t body = 0; body < frame.poses.size(); ++body) {
            if (frame.deformed[body].empty())
                frame.poses[body].translation = on_grid(frame.poses[body].translation) + offset;
            for (auto& v : frame.deformed[body]) v = on_grid(v) + offset;
        }
        return frame;
    };
    return scene;
}

const Vector far_offset(4096, -(1 << 20), 1 << 13);

TEST(Origin, OfACentredSceneIsTheWorldOrigin) {
    EXPECT_EQ(origin_of(crowd_at(Vector::Zero()), Origin::automatic), Vector::Zero());
    EXPECT_EQ(origin_of(crowd_at(far_offset), Origin::world), Vector::Zero());
}

TEST(Origin, OfAFarSceneIsInsideIt) {
    EXPECT_EQ(origin_of(crowd_at(far_offset), Origin::automatic), far_offset);
    const Vector between(1000.3, -77.7, 1e5);
    const auto scene = crowd_at(between);
    const auto origin = origin_of(scene, Origin::automatic);
    EXPECT_LE((origin - between).cwiseAbs().maxCoeff(), 4);
    for (const double x : origin) EXPECT_EQ(x, std::round(x)) << "a multiple of a power of two";
}

TEST(Origin, OfANonFiniteSceneIsTheWorldOrigin) {
    auto scene = crowd_at(far_offset);
    scene.frame = [known = scene.frame](std::size_t i) {
        auto frame = known(i);
        frame.poses[3].translation.x() = std::numeric_limits<double>::infinity();
        return frame;
    };
    EXPECT_EQ(origin_of(scene, Origin::automatic), Vector::Zero());
}

TEST(Origin, FramesAreRelativeToIt) {
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset);
    const FrameRange range(away, 0, 1);
    const auto frame = range.frame(1, Origin::automatic);
    const auto expected = near.frame(1);
    for (std::size_t body = 0; body < frame->poses.size(); ++body) {
        EXPECT_EQ(frame->poses[body].translation, expected.poses[body].translation);
        EXPECT_EQ(frame->deformed[body], expected.deformed[body]);
    }
    EXPECT_EQ(range.frame(1, Origin::world), range.frame(1));
}

class OriginSessions : public testing::TestWithParam<std::string> {
protected:
    std::unique_ptr<Session> prepare(const Scene& scene, SettingTexts settings) {
        settings.insert_or_assign("contact_rule", "sat");
        const auto& traversal = algorithm("chunked");
        const std::array devices{&device(GetParam())};
        return traversal.prepare(devices, scene,
                                 resolve(traversal.parameters(), {}, settings, traversal.name()));
    }
};

TEST_P(OriginSessions, AFarSceneGivesTheSameResultsAsANearOne) {
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset);
    for (const SettingTexts& settings : {SettingTexts{}, SettingTexts{{"residency", "published"}},
                                         SettingTexts{{"placement", "exact"}, {"broad", "tight"}}}) {
        auto counted = settings;
        counted.insert_or_assign("origin", "auto");
        const auto near_session = prepare(near, settings), far_session = prepare(away, counted);
        EXPECT_EQ(far_session->origin(), far_offset);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto expected = near_session->run(near.frame(i)), found = far_session->run(away.frame(i));
            EXPECT_GT(expected.contacts, 100u);
            EXPECT_EQ(found.digest(), expected.digest());
            EXPECT_EQ(found.contact_digest(), expected.contact_digest());
            const auto points = expected.download_contacts(), moved = found.download_contacts();
            ASSERT_EQ(moved.size(), points.size());
            for (std::size_t c = 0; c < points.size(); ++c)
                for (unsigned axis = 0; axis < 3; ++axis)
                    ASSERT_EQ(moved[c].point[axis], points[c].point[axis] + far_offset[axis]);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Devices, OriginSessions, testing::ValuesIn(device_names()),
                         [](const auto& test) { return device_label(test.param); });

} // namespace
} // namespace tandem
