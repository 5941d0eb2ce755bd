// SPDX-License-Identifier: MIT
// Sessions on several devices, each of which owns bodies: which bodies a device needs, partitions that
// expire, explicit pairs, and answers that always equal those of one device.
#include "algorithms/pipeline/resident_session.h"
#include "harness/verify/reference.h"
#include "tests/support/limited.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;

class Partitions : public testing::Test {
protected:
    static Settings settings_of(const Traversal& traversal, const SettingTexts& given) {
        return resolve(traversal.parameters(), traversal.presets().front().values, given, traversal.name());
    }
    static std::unique_ptr<Session> on_two_devices(const Traversal& traversal, const Scene& scene,
                                                   const SettingTexts& given = {}) {
        const std::array devices{&device("host"), &device("opencl:0")};
        return traversal.prepare(devices, scene, settings_of(traversal, given));
    }
    static std::unique_ptr<Session> on_host(const Traversal& traversal, const Scene& scene,
                                            const SettingTexts& given = {}) {
        return prepare_on(device("host"), traversal, scene, settings_of(traversal, given));
    }
    /// Every bit, and every count that devices made.
    static void expect_equal(const FrameResult& result, const FrameResult& right) {
        EXPECT_EQ(Answer(result).counts, Answer(right).counts);
        expect_same_digests(result, right);
    }
};

/// Frames of a moving scene in both directions, so partitions expire. Every frame equals that of one device.
TEST_F(Partitions, AnswersEqualOneDevice) {
    const auto scene = procession(24, 4, 0.35);
    for (const auto* traversal : algorithms())
        for (const std::string broad : {"device", "tight"}) {
            SCOPED_TRACE(fmt::format("{} {}", traversal->name(), broad));
            const auto both = on_two_devices(*traversal, scene, {{"broad", broad}});
            const auto one = on_host(*traversal, scene, {{"broad", broad}});
            std::uint64_t repartitions = 0;
            for (const std::size_t i : {0u, 1u, 2u, 3u, 0u, 3u, 3u}) {
                const auto result = both->run(scene.frame(i));
                ASSERT_GT(result.count, 0u);
                expect_equal(result, one->run(scene.frame(i)));
                repartitions += result.repartitions;
            }
            EXPECT_GT(repartitions, 1u);
        }
}

/// Without Scene::frame the first frame decides the origin of all devices, after reset() the next one.
TEST_F(Partitions, TheFirstFrameDecidesTheOriginOfAllDevices) {
    const auto scene = procession(24, 2, 0.35);
    auto bare = scene;
    bare.frame = nullptr;
    for (const std::string broad : {"device", "tight"}) {
        const auto both = on_two_devices(algorithm("tiled"), bare, {{"broad", broad}});
        const auto one = on_host(algorithm("tiled"), bare, {{"broad", broad}});
        for (const double offset : {0x1p20, 0.0, -0x1p12}) {
            const auto away = moved(scene, {offset, 0, 0});
            for (std::size_t i = 0; i < 2; ++i) {
                const auto result = both->run(away.frame(i));
                ASSERT_GT(result.contacts, 0u);
                expect_equal(result, one->run(away.frame(i)));
            }
            EXPECT_EQ(both->origin(), one->origin());
            EXPECT_EQ(both->origin().x() != 0, offset != 0);
            both->reset();
            one->reset();
        }
    }
}

/// Bodies that move as the origin does have not moved for a partition, but the fixed one has.
TEST_F(Partitions, APartitionOfAnotherOriginIsNotKept) {
    const auto scene = passing();
    auto bare = scene;
    bare.frame = nullptr;
    for (const std::string broad : {"device", "tight"}) {
        const auto both = on_two_devices(algorithm("tiled"), bare, {{"broad", broad}});
        both->run(scene.frame(0));
        both->reset();
        const auto right = on_host(algorithm("tiled"), bare, {{"broad", broad}})->run(scene.frame(1));
        EXPECT_EQ(right.download().front().body_a, 0u) << "the fixed body";
        expect_equal(both->run(scene.frame(1)), right);
    }
}

/// In a row, a device needs its own half and the neighbours at the cut, and processes all of them.
TEST_F(Partitions, EachDeviceRefitsOnlyTheBodiesItNeeds) {
    const auto scene = procession(60, 2, 0.01);
    const auto session = on_two_devices(algorithm("tiled"), scene);
    const auto result = session->run(scene.frame(0));
    ASSERT_EQ(result.shared.size(), 2u);
    EXPECT_EQ(result.shared[0].pairs + result.shared[1].pairs, result.count);
    EXPECT_EQ(result.shared[0].body_pairs + result.shared[1].body_pairs, result.body_pairs);
    for (const auto& work : result.shared) {
        EXPECT_GT(work.bodies, 20u);
        EXPECT_LT(work.bodies, 40u);
        EXPECT_GT(work.ns, 0);
    }
    EXPECT_EQ(result.repartitions, 1u);
    EXPECT_EQ(session->run(scene.frame(1)).repartitions, 0u) << "the partition is valid: no body moved far";
}

/// Bodies jump so far in every frame that no skin helps: soon both devices have all bodies.
TEST_F(Partitions, JumpingBodiesAreOnAllDevices) {
    const auto scene = procession(12, 2, 40);
    const auto both = on_two_devices(algorithm("chunked"), scene);
    const auto one = on_host(algorithm("chunked"), scene);
    for (std::size_t i = 0; i < 12; ++i) {
        const auto result = both->run(scene.frame(i % 2));
        expect_equal(result, one->run(scene.frame(i % 2)));
        if (i >= 6) {
            EXPECT_EQ(result.shared[0].bodies, 12u);
        }
    }
}

/// Explicit pairs of distant bodies, which no partition provides for.
TEST_F(Partitions, ExplicitPairsMayNameAnyBodies) {
    const auto scene = procession(10, 1, 0);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto both = on_two_devices(*traversal, scene);
        const auto one = on_host(*traversal, scene);
        for (const auto& pairs :
             {std::vector<BodyPair>{{0, 9}, {3, 4}, {4, 5}, {2, 8}}, all_pairs(scene), {}})
            expect_equal(both->run(scene.frame(0), pairs), one->run(scene.frame(0), pairs));
        expect_equal(both->run(scene.frame(0)), one->run(scene.frame(0)));
    }
}

/// One moving and one fixed body: one device has no work.
TEST_F(Partitions, MoreDevicesThanBodies) {
    auto scene = procession(3, 1, 0);
    scene.bodies[1] = {.mesh = 0, .fixed = true};
    const auto frame = scene.frame;
    scene.frame = [frame](std::size_t i) {
        auto all = frame(i);
        all.deformed[1].clear();
        all.poses[1].translation = {0.4, 0, 0};
        return all;
    };
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto result = on_two_devices(*traversal, scene)->run(scene.frame(0));
        ASSERT_GT(result.count, 0u);
        expect_equal(result, on_host(*traversal, scene)->run(scene.frame(0)));
    }
}

/// Partitioned work with buffers of one row and with skipped tetrahedra.
TEST_F(Partitions, CapacitiesOfOneAndSkippedTetrahedra) {
    const auto scene = procession(8, 2, 0.3);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const SettingTexts given{
            {"pair_capacity", "1"}, {"contact_capacity", "1"}, {"body_pair_capacity", "1"}};
        const auto both = on_two_devices(*traversal, scene, given);
        const auto one = on_host(*traversal, scene);
        for (std::size_t i = 0; i < 2; ++i) {
            auto frame = scene.frame(i);
            expect_equal(both->run(frame), one->run(frame));
            frame.skipped.resize(8);
            frame.skipped[2] = {0, 3, 7};
            frame.skipped[5] = {1};
            expect_equal(both->run(frame), one->run(frame));
        }
    }
}

/// A frame announced with expect() fits into its buffers and needs no retry.
TEST_F(Partitions, ExpectedFramesRunOnce) {
    const auto scene = procession(8, 1, 0);
    const auto settings =
        settings_of(algorithm("tiled"), {{"pair_capacity", "1"}, {"contact_capacity", "1"}});
    // expect() is a resident session's own, and only Traversal::prepare makes sessions that check frames.
    const auto session = [&] {
        return ResidentSession(algorithm("tiled"), device("host"), scene,
                               algorithm("tiled").fitted(settings, device("host").info(), &scene));
    };
    auto unprepared = session(), prepared = session();
    const auto frame = scene.frame(0);
    const auto result = unprepared.run(FrameView(frame).checked());
    EXPECT_GT(result.retries, 0u);
    ASSERT_GT(result.contacts, 0u);
    prepared.expect(result.count, result.contacts_a_pair());
    const auto again = prepared.run(FrameView(frame).checked());
    EXPECT_EQ(again.retries, 0u);
    expect_equal(again, result);
    EXPECT_EQ(prepared.run(FrameView(frame).checked()).retries, 0u)
        << "while the last answer is kept, with other buffers";
    // Buffers alternate while the last answer is kept.
    auto apart = frame;
    for (std::size_t body = 0; body < 8; ++body) {
        apart.poses[body].translation.x() = 100.0 * static_cast<double>(body);
        for (auto& vertex : apart.deformed[body]) vertex.x() += 100.0 * static_cast<double>(body);
    }
    auto later = session();
    auto last = later.run(FrameView(apart).checked());
    last = later.run(FrameView(apart).checked());
    ASSERT_EQ(last.count, 0u);
    last = later.run(FrameView(frame).checked());
    ASSERT_GT(last.retries, 0u);
    for (int i = 0; i < 4; ++i) {
        last = later.run(FrameView(frame).checked());
        EXPECT_EQ(last.retries, 0u) << "the capacities were sufficient before";
    }
}

/// Batches, needed for lack of memory, search only the subdomain's body pairs, on the device and on the host.
TEST_F(Partitions, FramesInBatches) {
    const auto scene = procession(30, 1, 0);
    const auto one = on_host(algorithm("tiled"), scene)->run(scene.frame(0));
    auto& limited = device("opencl:0");
    // With memory for some body pairs, and with none: then the host finds them.
    for (const std::size_t spare : {3'000u, 0u}) {
        const auto both = on_two_devices(
            algorithm("tiled"), scene,
            {{"pair_capacity", "256"}, {"contact_capacity", "256"}, {"body_pair_capacity", "1"}});
        const std::vector<BodyPair> few{{2, 3}};
        both->run(scene.frame(0), few); // partitions, and grows no buffer of body pairs
        limited.set_memory_limit(limited.bytes_allocated() + spare);
        const auto result = both->run(scene.frame(0));
        limited.set_memory_limit(Device::no_memory_limit);
        EXPECT_GT(result.batches, 2u);
        EXPECT_LE(result.body_pairs, BroadSweep(scene, {}, Broad::tight).pairs(scene.frame(0)).size())
            << "no pair belongs to two subdomains";
        EXPECT_EQ(result.count, one.count);
        expect_same_digests(result, one);
    }
}

/// The error names the device that ran out of memory; with memory again, the session continues.
TEST_F(Partitions, AnErrorNamesTheFailingDevice) {
    const auto scene = procession(30, 2, 5);
    const auto both = on_two_devices(algorithm("tiled"), scene);
    const auto one = on_host(algorithm("tiled"), scene);
    expect_equal(both->run(scene.frame(0)), one->run(scene.frame(0)));
    auto& limited = device("opencl:0");
    limited.set_memory_limit(1);
    std::string message;
    try {
        both->run(scene.frame(1));
    } catch (const OutOfMemory& error) {
        message = error.what();
    }
    limited.set_memory_limit(Device::no_memory_limit);
    EXPECT_THAT(message, HasSubstr("opencl:0"));
    for (const std::size_t i : {1u, 0u}) expect_equal(both->run(scene.frame(i)), one->run(scene.frame(i)));
}

/// Counts on the device, and for pairs downloaded to the host.
TEST_F(Partitions, PairsAreCountedByBody) {
    const auto scene = procession(12, 1, 0);
    for (const std::string name : {"host", "opencl:0"}) {
        const std::array one{&device(name)};
        const auto& traversal = algorithm("tiled");
        const auto result = traversal.prepare(one, scene, settings_of(traversal, {}))->run(scene.frame(0));
        std::vector<std::uint64_t> right(12), counts;
        for (const auto& pair : result.download()) {
            ++right[pair.body_a];
            ++right[pair.body_b];
        }
        for (const auto& part : result.parts) part->count_by_body(counts);
        EXPECT_EQ(counts, right) << name;
    }
}

} // namespace
} // namespace tandem
