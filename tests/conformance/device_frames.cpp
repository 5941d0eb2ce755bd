// SPDX-License-Identifier: MIT
// Frames whose numbers are in device memory: the same bits and answers as for the same frame in host memory,
// the same errors for invalid values, and a one-line error for settings that need the host.
#include "algorithms/answer/status.h"
#include "algorithms/bodies/frame_on_device.h"
#include "algorithms/bodies/pack_stage.h"
#include "algorithms/bodies/range.h"
#include "base/quaternion.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/frames_there.h"
#include "tests/support/long_form.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

/// The scene, in which every second body is deformable: its vertices have moved by its pose.
Scene softened(Scene scene) {
    const auto bodies = scene.bodies;
    for (std::size_t body = 1; body < bodies.size(); body += 2) scene.bodies[body].deformable = true;
    scene.frame = [rigid = scene.frame, bodies, meshes = scene.meshes](std::size_t number) {
        auto frame = rigid(number);
        for (std::size_t body = 1; body < bodies.size(); body += 2) {
            if (bodies[body].deformable) continue;
            const auto [rotation, translation] = std::exchange(frame.poses[body], {});
            for (const auto& vertex : meshes[bodies[body].mesh].vertices)
                frame.deformed[body].push_back(rotation * vertex + translation);
        }
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

class DeviceFrames : public OnDevice {
protected:
    std::unique_ptr<Session> prepare(std::string_view name, const Scene& scene, const SettingTexts& given) {
        const auto& traversal = algorithm(name);
        return prepare_on(on, traversal, scene, given);
    }

    static void expect_equal(const FrameResult& result, const FrameResult& right) {
        EXPECT_GT(right.count, 50u);
        EXPECT_EQ(result.download(), right.download());
        EXPECT_EQ(result.digest(), right.digest());
        EXPECT_EQ(result.contacts, right.contacts);
        EXPECT_EQ(result.contact_digest(), right.contact_digest());
        EXPECT_EQ(result.download_contacts().size(), right.download_contacts().size());
    }

    /// Frames of the scene from both memories: a session for each, and a third session that alternates.
    void expect_same_answers(std::string_view name, const Scene& scene, const SettingTexts& given) {
        SCOPED_TRACE(fmt::format("{}{}", name, text(given)));
        const auto from_host = prepare(name, scene, given);
        const auto from_device = prepare(name, scene, given);
        const auto both = prepare(name, scene, given);
        for (std::size_t i = 0; i < 4; ++i) {
            const Rows rows(scene.frame(i % scene.frame_count), i % 2 == 1);
            const auto right = from_host->run(rows.host);
            const auto frame = rows.uploaded_to(on);
            expect_equal(from_device->run(frame), right);
            expect_equal(i % 3 == 0 ? both->run(rows.host) : both->run(frame), right);
            expect_equal(from_device->run(frame, all_pairs(scene)), right);
        }
    }

    template<class Real>
    std::vector<Real> reals(const Buffer& from, std::size_t count) {
        std::vector<Real> values(count);
        const StageScope scope(on, Stage::read);
        on.download(from, std::as_writable_bytes(std::span(values)));
        return values;
    }
};

TEST_P(DeviceFrames, GiveTheAnswerOfFramesInHostMemory) {
    const auto scene = crowd(3, 12, 1.5);
    for (const auto* traversal : walks())
        for (const auto& given :
             {SettingTexts{{"k", "18"}}, {{"k", "8"}, {"precision", "double"}, {"broad", "device"}}})
            expect_same_answers(traversal->name(), scene, given);
    expect_same_answers("tiled", scene, {{"k", "18"}, {"submission", "each"}, {"pair_layout", "items"}});
}

TEST_P(DeviceFrames, UseTheOriginOfTheSession) {
    auto scene = crowd(5, 8, 1.2);
    scene.frame = [inner = scene.frame](std::size_t i) {
        auto frame = inner(i);
        for (auto& pose : frame.poses) pose.translation += Eigen::Vector3d(1e5, -3e5, 7);
        for (auto& vertex : frame.deformed[1]) vertex += Eigen::Vector3d(1e5, -3e5, 7);
        frame.poses[1] = {};
        return frame;
    };
    expect_same_answers("tiled", scene, {{"k", "18"}, {"precision", "double"}});
}

/// Without Scene::frame the first frame decides, from either memory; a frame that is refused does not.
TEST_P(DeviceFrames, DecideTheOriginOfTheSession) {
    const auto scene = crowd(5, 8, 1.2);
    auto bare = scene;
    bare.frame = nullptr;
    const auto from_host = prepare("tiled", bare, {}), from_device = prepare("tiled", bare, {});
    for (const double x : {1e5, 0.0, -3e6}) {
        const Rows rows(moved(scene, {x, 0, 0}).frame(0), false);
        const Rows flawed(moved(scene, {2e37, 0, 0}).frame(0), false);
        EXPECT_NE(message_of([&] { from_device->run(flawed.uploaded_to(on)); }), "no error");
        const auto right = from_host->run(rows.host);
        expect_equal(from_device->run(rows.uploaded_to(on)), right);
        EXPECT_EQ(from_device->origin(), from_host->origin());
        EXPECT_EQ(from_device->origin().x() != 0, x != 0);
        from_host->reset();
        from_device->reset();
    }
}

/// Vertices of deformable bodies of two meshes, and of one without a field, get their pressures in the
/// device's memory.
TEST_P(DeviceFrames, KeepPressures) {
    auto scene = softened(crowd(3, 12, 1.2));
    scene.meshes[2].pressures.clear();
    const SettingTexts polygons{{"contact_rule", "pressure"}, {"order", "canonical"}};
    for (auto given : {polygons, SettingTexts{{"contact_rule", "pressure"}, {"precision", "double"}}}) {
        expect_same_answers("tiled", scene, given);
        if (compiles_briefly()) break;
        given["output"] = "wrenches";
        expect_same_answers("tiled", scene, given);
    }
    expect_same_answers("chunked", scene, polygons);
    const Rows rows(scene.frame(0), false);
    const auto found = prepare("tiled", scene, polygons)->run(rows.uploaded_to(on)).download_contacts();
    const auto right = prepare("tiled", scene, polygons)->run(rows.host).download_contacts();
    ASSERT_EQ(found.size(), right.size());
    std::set<std::uint32_t> soft;
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].pair, right[i].pair);
        EXPECT_EQ(found[i].point, right[i].point);
        EXPECT_EQ(found[i].depth, right[i].depth);
        EXPECT_EQ(found[i].pressure, right[i].pressure);
        for (const auto body : {found[i].pair.body_a, found[i].pair.body_b})
            if (scene.bodies[body].deformable) soft.insert(scene.bodies[body].mesh);
    }
    EXPECT_EQ(soft, (std::set<std::uint32_t>{0, 1}));
}

TEST_P(DeviceFrames, CentreDistantMeshes) {
    const auto scene = with_distant_meshes(crowd(5, 8, 1.2), {1e6, 3e4, 0});
    for (const std::string precision : {"float", "double"})
        expect_same_answers("tiled", scene, {{"k", "18"}, {"origin", "auto"}, {"precision", precision}});
}

TEST_P(DeviceFrames, IgnoreSkippedTetrahedra) {
    const auto scene = crowd(4, 9, 1.2);
    const auto from_host = prepare("chunked", scene, {}), from_device = prepare("chunked", scene, {});
    for (std::size_t i = 0; i < 3; ++i) {
        auto frame = scene.frame(0);
        if (i == 1) {
            frame.skipped.resize(scene.bodies.size());
            for (std::uint32_t t = 0; t < 40; ++t) frame.skipped[0].push_back(t);
        }
        const Rows rows(frame, false);
        expect_equal(from_device->run(rows.uploaded_to(on)), from_host->run(rows.host));
    }
}

/// Every buffer starts with one row, and memory is so limited that the frame runs in batches.
TEST_P(DeviceFrames, RunWithRetriesAndInBatches) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(6, 16, 1.5);
    const SettingTexts least{{"pair_capacity", "1"}, {"contact_capacity", "1"}, {"body_pair_capacity", "1"}};
    const Rows rows(scene.frame(0), false);
    const auto right = prepare("chunked", scene, {})->run(rows.host);
    const auto session = prepare("chunked", scene, least);
    const auto frame = rows.uploaded_to(on);
    const auto again = session->run(frame);
    expect_equal(again, right);
    EXPECT_GT(again.retries, 0u);
    const auto small = prepare("chunked", scene, least);
    small->run(frame);
    const auto limited_session = prepare("chunked", scene, least);
    on.set_memory_limit(on.bytes_allocated() + 20000);
    const auto parts = limited_session->run(frame);
    on.set_memory_limit(Device::no_memory_limit);
    EXPECT_GT(parts.batches, 1u);
    expect_equal(parts, right);
}

/// Poses and vertices have the bits that Bodies::update uploads, for quaternions of all lengths and
/// directions.
TEST_P(DeviceFrames, ArePackedToTheBitsOfTheHost) {
    Random random(11);
    Scene scene = crowd(7, 2, 1);
    for (std::uint32_t i = 0; i < 2000; ++i) scene.bodies.push_back({.mesh = 2});
    auto frame = scene.frame(0);
    frame.deformed.resize(scene.bodies.size());
    for (auto& v : frame.deformed[1]) v *= std::exp2(random.uniform(-60, 60));
    while (frame.poses.size() < scene.bodies.size())
        frame.poses.push_back({random.rotation(), Eigen::Vector3d(random.uniform(-1, 1), -0.0, 0.0)
                                                      * std::exp2(random.uniform(-60, 60))});
    Rows rows(frame, false);
    for (std::size_t body = 2; body < scene.bodies.size(); ++body) {
        auto* q = &rows.poses[7 * body + 3];
        const auto expected = tandem::unit(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
        const double power = std::exp2(std::floor(random.uniform(-1000, 1000)));
        for (std::size_t i = 0; i < 4; ++i) q[i] *= power; // changes no bits of the rotation
        rows.host.poses[body] = pose_of_row(&rows.poses[7 * body], body);
        EXPECT_EQ(rows.host.poses[body].rotation.coeffs(), expected.coeffs());
    }
    auto other = rows.host; // overwrites everything of the previous frame
    for (auto& v : other.deformed[1]) v *= 2;
    std::ranges::fill(other.poses, Pose{});
    for (const auto& geometry : {Geometry{.precision = Precision::fp32},
                                 {.precision = Precision::fp64},
                                 {.precision = Precision::fp32, .pressures = true}}) {
        Bodies bodies(on, scene, geometry, Bodies::Sharing::by_mesh);
        const Status status(on, Status::Writes::queued);
        const PackStage pack(bodies, {on.info().max_group_size == 1 ? 1u : 64u, 3});
        const auto words = [&](const Buffer& buffer, std::size_t count) {
            return reals<std::uint32_t>(buffer, count * real_bytes(geometry) / 4);
        };
        bodies.update(rows.host);
        const auto poses = words(bodies.poses(), 12 * scene.bodies.size());
        const auto vertices = words(bodies.vertices(), 4 * bodies.vertex_total());
        bodies.update(other);
        EXPECT_NE(words(bodies.vertices(), 4 * bodies.vertex_total()), vertices);
        pack.launch(rows.uploaded_to(on), Eigen::Vector3d::Zero(), status.buffer());
        EXPECT_EQ(words(bodies.poses(), 12 * scene.bodies.size()), poses);
        EXPECT_EQ(words(bodies.vertices(), 4 * bodies.vertex_total()), vertices);
    }
}

/// Values out of range give the same error as in host memory, and the next frame runs.
TEST_P(DeviceFrames, OutOfRangeValuesGiveTheErrorsOfTheHost) {
    const auto scene = crowd(3, 12, 1.5);
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    const auto session = prepare("tiled", scene, {});
    const auto good = session->run(Rows(scene.frame(0), false).host);
    for (const auto& [at, value, words] :
         {std::tuple{7 * 3 + 0, nan, "poses: row 3 is not finite"},
          {7 * 0 + 2, -infinity, "poses: row 0 is not finite"},
          {7 * 5 + 4, nan, "poses: row 5 has no rotation"},
          {7 * 5 + 4, infinity, "poses: row 5 has no rotation"},
          {7 * 11 + 1, 2e36, "body 11 has a coordinate of 2e+36, and precision=float takes at most 1e+36"},
          {-1, nan, "body 1: vertex 9 is not finite; repair the frame"},
          {-1, -1e37, "body 1 has a coordinate of 1e+37"}}) {
        SCOPED_TRACE(words);
        Rows rows(scene.frame(0), false);
        if (at < 0)
            rows.host.deformed[1][9].y() = value;
        else
            rows.poses[static_cast<std::size_t>(at)] = value;
        const auto frame = rows.uploaded_to(on);
        EXPECT_THAT(message_of([&] { session->run(frame); }), HasSubstr(words));
        EXPECT_EQ(message_of([&] {
                      for (std::size_t body = 0; body < scene.bodies.size(); ++body)
                          if (!scene.bodies[body].deformable)
                              rows.host.poses[body] = pose_of_row(&rows.poses[7 * body], body);
                      check_range(scene, rows.host, Geometry{});
                  }),
                  message_of([&] { session->run(frame); }));
        expect_equal(session->run(Rows(scene.frame(0), false).uploaded_to(on)), good);
    }
    for (int i = 3; i < 7; ++i) {
        Rows rows(scene.frame(0), false);
        for (std::size_t j = 3; j < 7; ++j) rows.poses[7 * 4 + j] = 0;
        EXPECT_THAT(message_of([&] { session->run(rows.uploaded_to(on)); }),
                    HasSubstr("poses: row 4 has no rotation"));
    }
}

TEST_P(DeviceFrames, AreRejectedInOneLineWhereTheHostNeedsThem) {
    const auto scene = crowd(3, 6, 1.5);
    const auto frame = Rows(scene.frame(0), false).uploaded_to(on);
    const auto rejection_with = [&](const SettingTexts& given) {
        const auto session = prepare("chunked", scene, given);
        return message_of([&] { session->run(frame); });
    };
    EXPECT_THAT(rejection_with({{"residency", "published"}, {"broad", "sphere"}}),
                HasSubstr("residency=published converts every frame"));
    EXPECT_THAT(rejection_with({{"placement", "exact"}}), HasSubstr("placement=exact bounds on the host"));
    const auto session = prepare("tiled", scene, {});
    const auto without = [&](const auto& change) {
        auto changed = frame;
        change(changed);
        return message_of([&] { session->run(changed); });
    };
    EXPECT_THAT(without([](auto& f) { f.deformed[1] = {}; }),
                HasSubstr("vertices of body 1: a buffer of 0 bytes"));
    EXPECT_THAT(without([](auto& f) { f.deformed.clear(); }),
                HasSubstr("0 entries of vertices for 6 bodies"));
    EXPECT_THAT(without([&](auto& f) { f.poses.buffer = on.allocate(80, "few"); }),
                HasSubstr("poses: a buffer of 80 bytes"));
    EXPECT_EQ(without([](auto& f) { f.poses = {}; }), "no error") << "all at the identity";
    auto rigid = scene;
    rigid.bodies[1].deformable = false;
    const auto rigid_session = prepare("tiled", rigid, {});
    EXPECT_EQ(rigid_session->run(DeviceFrame{frame.poses, {}}).digest(), rigid_session->run(frame).digest());
    const std::array both{&device("host"), &device("opencl:0")};
    const auto& tiled = algorithm("tiled");
    const auto split = tiled.prepare(both, scene, resolved(tiled));
    EXPECT_THAT(message_of([&] { split->run(frame); }), HasSubstr("several devices share a frame"));
}

TANDEM_ON_DEVICES(DeviceFrames);

} // namespace
} // namespace tandem
