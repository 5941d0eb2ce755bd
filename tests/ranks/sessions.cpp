// SPDX-License-Identifier: MIT
// Sessions on the ranks of a job that a launcher has started. The answers together equal those of one device,
// every pair is found once, and an error of one rank is an error of all. Every rank runs every test.
#include "algorithms/answer/digest.h"
#include "algorithms/bodies/ball.h"
#include "algorithms/distributed/job_session.h"
#include "base/error.h"
#include "tests/ranks/support.h"
#include "tests/support/message_of.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

/// Tetrahedra in a lattice with `side` of them along each axis; neighbours in a row touch.
Scene lattice(std::uint32_t side) {
    Scene scene;
    scene.name = scene.key = "lattice";
    scene.meshes = {one_tetrahedron(1)};
    scene.bodies.resize(std::size_t{side} * side * side);
    scene.frame = [side](std::size_t) {
        Frame frame;
        for (std::uint32_t i = 0; i < side * side * side; ++i)
            frame.poses.push_back(
                {.translation = {1.0 * (i % side), 1.5 * (i / side % side), 1.5 * (i / side / side)}});
        frame.deformed.resize(frame.poses.size());
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// Frames in both directions, so ghost bodies change. A deformable body's vertices are exchanged, and results
/// outlive the session parts that contain them.
TEST_F(RankSessions, CombinedAnswersEqualOneDevice) {
    const auto scene = procession(24, 4, 0.35);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto session = traversal->prepare(own_device(), scene, settings_of(*traversal), *job);
        const auto one = alone(*traversal, scene);
        std::vector<FrameResult> kept;
        for (const std::size_t i : {0u, 1u, 2u, 3u, 0u, 3u, 3u}) {
            expect_equal(scene, *session, *one, i);
            kept.push_back(last_);
        }
        EXPECT_EQ(summed(kept.front().digest()), one->run(scene.frame(0)).digest());
    }
}

/// Ranks exchange poses of centred meshes.
TEST_F(RankSessions, CombinedAnswersOfDistantMeshesEqualOneDevice) {
    const auto scene = with_distant_meshes(procession(24, 4, 0.35), {1e6});
    const auto& traversal = algorithm("tiled");
    const auto settings = settings_of(traversal, {{"origin", "auto"}});
    const auto session = traversal.prepare(own_device(), scene, settings, *job);
    const auto one = alone(traversal, scene, {{"origin", "auto"}});
    for (const std::size_t i : {0u, 1u, 3u, 0u}) expect_equal(scene, *session, *one, i);
}

/// Bodies and meshes; here every body has its own mesh.
TEST_F(RankSessions, UploadOnlyOwnAndGhostBodies) {
    auto scene = procession(400, 1, 0.35);
    scene.meshes.resize(scene.bodies.size(), scene.meshes.front());
    for (std::uint32_t body = 0; body < scene.bodies.size(); ++body) scene.bodies[body].mesh = body;
    const auto& traversal = algorithm("tiled");
    auto& on = own_device();
    const auto settings = settings_of(traversal, {{"pair_capacity", "1"},
                                                  {"contact_capacity", "1"},
                                                  {"tile_pair_capacity", "1"},
                                                  {"body_pair_capacity", "1"}});
    const auto before = on.bytes_allocated();
    const auto session = traversal.prepare(on, scene, settings, *job);
    const auto shared = on.bytes_allocated() - before;
    const std::array one{&on};
    const auto whole = traversal.prepare(one, scene, settings);
    const auto all = on.bytes_allocated() - before - shared;
    EXPECT_LT(static_cast<double>(shared), (0.1 + 1.0 / job->size()) * static_cast<double>(all));
    expect_equal(scene, *session, *whole, 0);
    const auto& own = last_.shared[static_cast<std::size_t>(job->rank())];
    EXPECT_LT(own.bodies, 400u / static_cast<unsigned>(job->size()) + 20u);
    if (job->size() > 1) {
        EXPECT_GT(summed(own.exchange_bytes), 0u);
        EXPECT_LT(own.exchange_bytes, 400u * 144) << "only bodies at the border are exchanged";
    }
}

/// Bodies in a row. In frame 0 each is within skins (a quarter of a radius) of the next body. In frame 1 it
/// also comes within skins of the one after that, which was a fifth of a radius too far away.
Scene approaching_row(std::uint32_t bodies) {
    auto scene = procession(bodies, 2, 0);
    scene.bodies.assign(bodies, Body{});
    const auto& vertices = scene.meshes.front().vertices;
    const auto [first, last] =
        std::ranges::minmax(vertices, {}, [](const Eigen::Vector3d& vertex) { return vertex.x(); });
    const double radius = ball_around(vertices).radius;
    const double near = last.x() - first.x() + 2 * 0.25 * radius;
    scene.frame = [=](std::size_t number) {
        Frame frame;
        frame.deformed.resize(bodies);
        const double apart = (near + (number == 0 ? 0.1 : -0.1) * radius) / 2;
        for (std::uint32_t i = 0; i < bodies; ++i)
            frame.poses.push_back({Eigen::Quaterniond::Identity(), {apart * i, 0, 0}});
        return frame;
    };
    scene.digest = digest_of(scene);
    return scene;
}

/// After a partition has been valid for long, so that skins do not grow, every rank but the last gets new
/// ghost bodies. They were next in distance, so a device that got its bodies for this partition has them. A
/// device that had all bodies of a new partition kept them, and may have to get others in frame 1.
TEST_F(RankSessions, NextGhostsFitIntoTheSession) {
    const auto scene = approaching_row(200);
    const auto& traversal = algorithm("tiled");
    const auto session =
        traversal.prepare(own_device(), scene, settings_of(traversal, {{"contact_rule", "none"}}), *job);
    const auto& on_rank = dynamic_cast<const RankSession&>(*session);
    const auto stored = [&] {
        const auto bodies = on_rank.stored_bodies();
        return std::vector(bodies.begin(), bodies.end());
    };
    const auto run = [&](std::size_t frame) {
        last_ = session->run(own_frame(scene, *session, frame));
        return last_.shared[static_cast<std::size_t>(job->rank())].bodies;
    };
    bool is_stored_for_it = true;
    std::size_t of_subdomain = 0, with_ghosts = 0;
    std::vector<std::uint32_t> earlier;
    // Measured times decide when bodies are partitioned again. If that is in frame 1, it begins again.
    for (int attempt = 0; attempt < 50 && (attempt == 0 || last_.repartitions != 0); ++attempt) {
        of_subdomain = run(0);
        for (int unchanged = 0, i = 0; unchanged < 10 && i < 5000; ++i) {
            const bool is_new = last_.repartitions != 0;
            earlier = stored();
            of_subdomain = run(0);
            if (is_new) is_stored_for_it = stored() != earlier;
            unchanged = last_.repartitions == 0 ? unchanged + 1 : 0;
        }
        earlier = stored();
        with_ghosts = run(1);
    }
    EXPECT_EQ(with_ghosts > of_subdomain, job->rank() + 1 < job->size());
    EXPECT_TRUE(!is_stored_for_it || stored() == earlier);
}

/// Every rank passes the skipped tetrahedra of its own bodies, in one frame and not in the next.
TEST_F(RankSessions, SkippedTetrahedraAreExchanged) {
    const auto scene = skipping(procession(24, 4, 0.05), [](std::uint32_t body, std::uint32_t frame) {
        return std::vector{body % 5, body % 5 + 3, 40 - frame};
    });
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto session = traversal->prepare(own_device(), scene, settings_of(*traversal), *job);
        const auto one = alone(*traversal, scene);
        for (const std::size_t i : {0u, 1u, 2u, 2u, 3u, 0u}) expect_equal(scene, *session, *one, i);
    }
}

/// If messages reach devices, vertices arrive there as rows of four floats; otherwise as three doubles
/// through the hosts. With placement=exact the hosts need them.
TEST_F(RankSessions, VerticesGoFromDeviceToDevice) {
    const auto scene = soft_procession(40, 3, 0.01);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        std::map<std::string, std::uint64_t> bytes;
        for (const std::string placement : {"rounded", "exact"}) {
            const SettingTexts given{{"placement", placement}};
            const auto settings = settings_of(*traversal, given);
            const auto session = traversal->prepare(own_device(), scene, settings, *job);
            const std::array one{&device("host")};
            const auto whole = traversal->prepare(one, scene, settings);
            for (const std::size_t i : {0u, 1u, 2u, 0u}) expect_equal(scene, *session, *whole, i);
            bytes[placement] = summed(last_.shared[static_cast<std::size_t>(job->rank())].exchange_bytes);
        }
        if (job->size() == 1) continue;
        EXPECT_EQ(4 * bytes["rounded"] <= 3 * bytes["exact"], job->is_gpu_aware(own_device().info()))
            << bytes["rounded"] << " and " << bytes["exact"];
    }
}

/// OpenCL memory has no pointers for MPI messages.
TEST_F(RankSessions, VerticesGoThroughHostsWithoutDevicePointers) {
    expect_frames_equal(soft_procession(20, 2, 0.01), algorithm("tiled"), device("opencl:0"));
}

/// The first rank's memory is enough for batches only; batches need all vertices on the host.
TEST_F(RankSessions, BatchesGetVerticesOnTheHost) {
    const auto scene = soft_procession(40, 3, 0.01);
    const auto& traversal = algorithm("chunked");
    auto& on = own_device();
    const SettingTexts small{
        {"pair_capacity", "64"}, {"contact_capacity", "64"}, {"body_pair_capacity", "8"}};
    const auto session = traversal.prepare(on, scene, settings_of(traversal, small), *job);
    const auto one = alone(traversal, scene);
    if (job->is_first()) on.set_memory_limit(on.bytes_allocated() + 20'000);
    const auto result = session->run(own_frame(scene, *session, 1));
    on.set_memory_limit(Device::no_memory_limit);
    const auto right = one->run(scene.frame(1));
    EXPECT_EQ(summed(result.digest()), right.digest());
    if (job->is_first()) {
        EXPECT_GT(result.batches, 1u);
    }
    for (const std::size_t i : {2u, 0u}) expect_equal(scene, *session, *one, i);
}

/// A device's broad phase numbers at most 2^20 bodies. A scene on ranks may have more because bodies of other
/// ranks have no numbers on the device.
TEST_F(RankSessions, MoreBodiesThanADeviceCanNumberOnlyLong) {
    ASSERT_GT(job->size(), 1) << "one rank has all bodies";
    constexpr std::uint32_t side = 103;
    const auto scene = lattice(side);
    ASSERT_GT(scene.bodies.size(), std::size_t{1} << 20);
    const auto& traversal = algorithm("tiled");
    EXPECT_THAT([&] { alone(traversal, scene); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("takes at most 1048576 bodies")));
    const auto session =
        traversal.prepare(own_device(), scene, settings_of(traversal, {{"contact_rule", "none"}}), *job);
    const auto result = session->run(scene.frame(0));
    EXPECT_EQ(summed(result.count), std::uint64_t{side - 1} * side * side) << "neighbours in rows touch";
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
        if (i % side + 1 < side) pairs.push_back({i, 0, i + 1, 0});
    EXPECT_EQ(summed(result.digest()), digest_of(pairs));
}

/// The rank that owns a body finds its pairs with itself. Each rank knows the filters of its bodies.
TEST_F(RankSessions, SelfPairsAndFilters) {
    auto scene = soft_procession(16, 2, 0.1);
    for (std::uint32_t body = 0; body < 16; ++body) scene.bodies[body].groups = body % 4 == 0 ? 2 : 1;
    for (std::uint32_t body = 1; body < 16; body += 6) scene.bodies[body].meets = 1;
    scene.never_meet = {{2, 3}, {7, 7}, {9, 10}};
    for (const auto* traversal : algorithms())
        for (const SettingTexts& given : {SettingTexts{{"self", "on"}}, {{"self", "deformable"}}}) {
            SCOPED_TRACE(traversal->name());
            expect_frames_equal(scene, *traversal, own_device(), given);
        }
}

TEST_F(RankSessions, CountsAndDigestsWithoutPairs) {
    const auto scene = procession(20, 1, 0);
    for (const std::string output : {"count", "digest"}) {
        const auto& traversal = algorithm("chunked");
        const auto session =
            traversal.prepare(own_device(), scene, settings_of(traversal, {{"output", output}}), *job);
        const auto right = alone(traversal, scene)->run(scene.frame(0));
        for (int i = 0; i < 4; ++i) {
            const auto result = session->run(own_frame(scene, *session, 0));
            EXPECT_EQ(summed(result.count), right.count);
            if (output == "digest") {
                EXPECT_EQ(summed(result.digest()), right.digest());
            }
        }
    }
}

/// Polygons of equal pressure, and their sums by body pair. Ghosts' pressures come with their meshes, and
/// some bodies have no field.
TEST_F(RankSessions, PolygonsAndWrenchesEqualOneDevice) {
    auto scene = soft_procession(24, 3, 0.1);
    scene.meshes.push_back(scene.meshes.front());
    scene.meshes.back().pressures.clear();
    for (std::uint32_t body = 5; body < 24; body += 7) scene.bodies[body].mesh = 1;
    scene.digest = digest_of(scene);
    for (const auto* traversal : algorithms())
        for (const SettingTexts& given :
             {SettingTexts{{"contact_rule", "pressure"}},
              {{"contact_rule", "pressure"}, {"output", "wrenches"}},
              {{"contact_rule", "pressure"}, {"output", "wrenches"}, {"precision", "double"}}}) {
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            expect_frames_equal(scene, *traversal, own_device(), given);
            EXPECT_GT(summed(last_.contacts), 10u);
        }
}

/// The rows of the job, in order, are those of one device; only some ranks have a body with a field.
TEST_F(RankSessions, RowsOfPressureEqualOneDevice) {
    auto scene = procession(24, 3, 0.35);
    scene.meshes.push_back(scene.meshes.front());
    scene.meshes.back().pressures.clear();
    for (std::uint32_t body = 3; body < 24; ++body) scene.bodies[body].mesh = 1;
    scene.digest = digest_of(scene);
    const auto& traversal = algorithm("tiled");
    for (const std::string output : {"pairs", "wrenches"}) {
        const SettingTexts given{{"contact_rule", "pressure"}, {"output", output}, {"order", "canonical"}};
        const auto right = alone(traversal, scene, given)->run(scene.frame(1)).download_contacts();
        JobSession session(*job, traversal.prepare(own_device(), scene, settings_of(traversal, given), *job));
        const auto found = session.run(FrameView(own_frame(scene, session, 1)).checked()).download_contacts();
        if (!job->is_first()) continue;
        ASSERT_EQ(found.size(), right.size());
        EXPECT_GE(right.size(), 2u);
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].pair, right[i].pair);
            EXPECT_EQ(found[i].point, right[i].point);
            EXPECT_EQ(found[i].normal, right[i].normal);
            EXPECT_EQ(found[i].depth, right[i].depth);
            EXPECT_EQ(found[i].pressure, right[i].pressure);
            EXPECT_EQ(found[i].feature, right[i].feature);
        }
    }
}

/// All ranks count from the middle of frame 0, and the job's contacts are in world coordinates.
TEST_F(RankSessions, FarScenesHaveOneOrigin) {
    const auto& traversal = algorithm("tiled");
    const auto near = procession(24, 3, 0.35), away = moved(near, {0x1p20, -0x1p22, 0});
    expect_frames_equal(away, traversal, own_device());
    const auto right = alone(traversal, near)->run(near.frame(0)).download_contacts();
    JobSession session(*job, traversal.prepare(own_device(), away, settings_of(traversal), *job));
    const auto found = session.run(FrameView(own_frame(away, session, 0)).checked()).download_contacts();
    if (!job->is_first()) return;
    ASSERT_EQ(found.size(), right.size());
    ASSERT_GT(right.size(), 100u);
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].pair, right[i].pair);
        EXPECT_NEAR(found[i].point[0], right[i].point[0] + 0x1p20, 1e-4);
        EXPECT_NEAR(found[i].point[1], right[i].point[1] - 0x1p22, 1e-4);
    }
}

/// A rank may own no bodies.
TEST_F(RankSessions, MoreRanksThanBodies) {
    expect_frames_equal(procession(3, 2, 0.1), algorithm("gproximity"), own_device());
}

/// The first rank's device has too little memory: all ranks report its error by rank number, and continue
/// when it has enough.
TEST_F(RankSessions, AnErrorOfOneRankIsReportedByAll) {
    const auto scene = procession(40, 2, 5);
    const auto& traversal = algorithm("tiled");
    auto& on = own_device();
    const auto session = traversal.prepare(on, scene, settings_of(traversal), *job);
    const auto one = alone(traversal, scene);
    expect_equal(scene, *session, *one, 0);
    last_ = {};
    if (job->is_first()) on.set_memory_limit(1);
    std::string message;
    try {
        session->run(own_frame(scene, *session, 1));
    } catch (const OutOfMemory& error) {
        message = error.what();
    }
    on.set_memory_limit(Device::no_memory_limit);
    EXPECT_THAT(message, testing::HasSubstr("rank 0: "));
    expect_equal(scene, *session, *one, 1);
    expect_equal(scene, *session, *one, 0);
}

TEST_F(RankSessions, RejectUnsupportedSettingsAndInput) {
    const auto scene = procession(5, 1, 0);
    const auto rejection = [&](const char* name, const SettingTexts& given) {
        const auto& traversal = algorithm(name);
        return support::message_of([&] {
            const auto session = traversal.prepare(own_device(), scene, settings_of(traversal, given), *job);
            const std::vector<BodyPair> pairs{{1, 2}};
            session->run(scene.frame(0), pairs);
        });
    };
    const auto& tiled = algorithm("tiled");
    const auto session = tiled.prepare(own_device(), scene, settings_of(tiled), *job);
    DeviceFrame input;
    input.poses = {own_device().allocate(5 * 7 * 8, "poses"), Precision::fp64};
    input.deformed.resize(5);
    input.deformed[1] = {own_device().allocate(scene.meshes[0].vertices.size() * 24, "vertices"),
                         Precision::fp64};
    EXPECT_THAT([&] { session->run(input); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("ranks of a job exchange bodies")));
    EXPECT_THAT(rejection("tiled", {{"broad", "tight"}}), testing::HasSubstr("choose broad=device"));
    EXPECT_THAT(rejection("chunked", {{"residency", "published"}}),
                testing::HasSubstr("cannot share a frame"));
    EXPECT_THAT(rejection("tiled", {}), testing::HasSubstr("which ranks of a job find themselves"));
}

} // namespace
} // namespace tandem
