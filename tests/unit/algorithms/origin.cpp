// SPDX-License-Identifier: MIT
// The coordinate origin with origin=auto: a distant scene gives the same results as the same scene near the
// world's origin.
#include "algorithms/bodies/origin.h"
#include "harness/frames/frames.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

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
    EXPECT_EQ(origin_of(Scene{}, Origin::automatic), Vector::Zero()) << "the first frame decides";
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

class OriginSessions : public OnDevice {
protected:
    std::unique_ptr<Session> prepare(const Scene& scene, SettingTexts settings) {
        settings.insert_or_assign("contact_rule", "sat");
        const auto& traversal = algorithm("chunked");
        return prepare_on(on, traversal, scene, settings);
    }
};

TEST_P(OriginSessions, AFarSceneGivesTheSameResultsAsANearOne) {
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset);
    for (const SettingTexts& settings : {SettingTexts{}, SettingTexts{{"residency", "published"}},
                                         SettingTexts{{"placement", "exact"}, {"broad", "tight"}}}) {
        if (compiles_briefly() && !settings.empty()) continue;
        const auto near_session = prepare(near, settings), far_session = prepare(away, settings);
        EXPECT_EQ(far_session->origin(), far_offset);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto expected = near_session->run(near.frame(i)), found = far_session->run(away.frame(i));
            EXPECT_GT(expected.contacts, 100u);
            expect_same_digests(found, expected);
            const auto points = expected.download_contacts(), moved = found.download_contacts();
            ASSERT_EQ(moved.size(), points.size());
            for (std::size_t c = 0; c < points.size(); ++c)
                for (unsigned axis = 0; axis < 3; ++axis)
                    ASSERT_EQ(moved[c].point[axis], points[c].point[axis] + far_offset[axis]);
        }
    }
}

/// The scene without its frames, as applications make it.
Scene without_frames(Scene scene) {
    scene.frame = nullptr;
    return scene;
}

/// After reset() the next frame decides. Body 0 is fixed, and must move with the origin.
TEST_P(OriginSessions, WithoutFramesOfTheSceneTheFirstOneDecides) {
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset), bare = without_frames(near);
    const auto input = [](const Frame& frame, const Frame& next, const Session& session) {
        return FrameInput(frame, session.settings()[parameters::motion] == Motion::linear ? &next : nullptr);
    };
    for (const SettingTexts& settings :
         {SettingTexts{}, SettingTexts{{"residency", "published"}}, SettingTexts{{"placement", "exact"}},
          SettingTexts{{"broad", "device"}}, SettingTexts{{"motion", "linear"}, {"decision", "exact"}}}) {
        if (compiles_briefly() && !settings.empty()) continue;
        const auto session = prepare(bare, settings), right = prepare(near, settings);
        const auto expect = [&](const Scene& at, std::size_t i, const Vector& origin) {
            const auto frame = at.frame(i), next = at.frame(1 - i);
            const auto expected_frame = near.frame(i), expected_next = near.frame(1 - i);
            const auto found = session->run(input(frame, next, *session));
            const auto expected = right->run(input(expected_frame, expected_next, *right));
            EXPECT_GT(expected.contacts, 100u);
            expect_same_digests(found, expected);
            EXPECT_EQ(session->origin(), origin);
            EXPECT_EQ(found.download_contacts().front().point[0],
                      expected.download_contacts().front().point[0] + origin.x());
        };
        expect(away, 0, far_offset);
        expect(away, 1, far_offset);
        session->run(input(near.frame(0), near.frame(1), *session));
        EXPECT_EQ(session->origin(), far_offset) << "a later frame decides nothing";
        session->reset();
        expect(near, 0, Vector::Zero());
        session->reset();
        expect(away, 1, far_offset);
    }
}

/// A frame after reset() has the bits of the first frame of a session, whatever ran before it.
TEST_P(OriginSessions, FixedBodiesMoveWithTheOrigin) {
    const auto scene = passing(), bare = without_frames(scene);
    for (const SettingTexts& settings : {SettingTexts{}, SettingTexts{{"broad", "device"}}}) {
        const auto session = prepare(bare, settings), fresh = prepare(bare, settings);
        session->run(scene.frame(0));
        EXPECT_EQ(session->origin(), Vector::Zero());
        session->reset();
        const auto found = session->run(scene.frame(1)), right = fresh->run(scene.frame(1));
        EXPECT_EQ(session->origin(), Vector(128, 0, 0));
        EXPECT_EQ(right.download().front().body_a, 0u) << "the fixed body";
        expect_same_digests(found, right);
    }
}

TEST_P(OriginSessions, AFrameThatIsRefusedDecidesNothing) {
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset), bare = without_frames(near);
    const auto session = prepare(bare, {});
    auto bad = away.frame(0);
    bad.poses[2].translation.x() = 1e37;
    EXPECT_THROW(session->run(bad), InputError);
    EXPECT_EQ(session->run(near.frame(0)).contact_digest(),
              prepare(near, {})->run(near.frame(0)).contact_digest());
    EXPECT_EQ(session->origin(), Vector::Zero());
}

/// So that cells and records of near scenes are those of origin=world.
TEST_P(OriginSessions, SettingsNameTheWorldWhereItIsTheOrigin) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto near = crowd_at(Vector::Zero()), away = crowd_at(far_offset), bare = without_frames(away);
    EXPECT_EQ(prepare(near, {})->settings().text("origin"), "world");
    EXPECT_EQ(prepare(away, {})->settings().text("origin"), "auto");
    EXPECT_EQ(prepare(bare, {})->settings().text("origin"), "auto") << "the first frame decides";
    const SettingTexts exact{{"placement", "exact"}};
    EXPECT_EQ(prepare(away, exact)->settings().text("origin"), "auto");
    if (!on.info().has_double) return;
    const auto session = prepare(away, {{"placement", "exact"}, {"precision", "double"}});
    EXPECT_EQ(session->settings().text("origin"), "world") << "its bounds cover no difference";
    EXPECT_EQ(session->origin(), Vector::Zero());
    for (const auto* traversal : algorithms())
        for (const auto& one : traversal->presets())
            EXPECT_EQ(traversal->settings({}, one.name).text("origin"),
                      one.name.starts_with("published") ? "world" : "auto")
                << traversal->name() << " " << one.name;
}

TANDEM_ON_DEVICES(OriginSessions);

} // namespace
} // namespace tandem
