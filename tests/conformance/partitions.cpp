// SPDX-License-Identifier: MIT
// Sessions on several devices, each of which owns bodies: who needs what, deals that end, pairs that are
// given, and answers that are those of one device whatever happens.
#include "algorithms/resident_session.h"
#include "harness/verify/reference.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tandem {
namespace {

using namespace testing_support;
using testing::HasSubstr;

class Shares : public testing::Test {
protected:
    static Settings settings_of(const Traversal& traversal, const SettingTexts& given) {
        return resolve(traversal.parameters(), traversal.presets().front().values, given, traversal.name());
    }
    static std::unique_ptr<Session> shared(const Traversal& traversal, const Scene& scene,
                                           const SettingTexts& given = {}) {
        const std::array devices{&device("host"), &device("opencl:0")};
        return traversal.prepare(devices, scene, settings_of(traversal, given));
    }
    static std::unique_ptr<Session> alone(const Traversal& traversal, const Scene& scene,
                                          const SettingTexts& given = {}) {
        const std::array devices{&device("host")};
        return traversal.prepare(devices, scene, settings_of(traversal, given));
    }
    /// Every bit, and the number of body pairs where both find them alike.
    static void expect_equal(const FrameResult& result, const FrameResult& right) {
        EXPECT_EQ(result.count, right.count);
        EXPECT_EQ(result.body_pairs, right.body_pairs);
        EXPECT_EQ(result.digest(), right.digest());
        EXPECT_EQ(result.contact_digest(), right.contact_digest());
    }
};

/// Frames of a scene that moves, there and back, so that deals end: the same as one device's in every frame.
TEST_F(Shares, AnswersAreThoseOfOneDevice) {
    const auto scene = procession(24, 4, 0.35);
    for (const auto* traversal : algorithms())
        for (const std::string broad : {"device", "tight"}) {
            SCOPED_TRACE(fmt::format("{} {}", traversal->name(), broad));
            const auto both = shared(*traversal, scene, {{"broad", broad}});
            const auto one = alone(*traversal, scene, {{"broad", broad}});
            std::uint64_t deals = 0;
            for (const std::size_t i : {0u, 1u, 2u, 3u, 0u, 3u, 3u}) {
                const auto result = both->run(scene.frame(i));
                ASSERT_GT(result.count, 0u);
                expect_equal(result, one->run(scene.frame(i)));
                deals += result.repartitions;
            }
            EXPECT_GT(deals, 1u);
        }
}

/// In a row a device needs its own half and what meets it at the cut, and does all of it.
TEST_F(Shares, EachDeviceMovesOnlyWhatItNeeds) {
    const auto scene = procession(60, 2, 0.01);
    const auto session = shared(algorithm("tiled"), scene);
    const auto result = session->run(scene.frame(0));
    ASSERT_EQ(result.shared.size(), 2u);
    EXPECT_EQ(result.shared[0].pairs + result.shared[1].pairs, result.count);
    EXPECT_EQ(result.shared[0].body_pairs + result.shared[1].body_pairs, result.body_pairs);
    for (const auto& share : result.shared) {
        EXPECT_GT(share.bodies, 20u);
        EXPECT_LT(share.bodies, 40u);
        EXPECT_GT(share.ns, 0);
    }
    EXPECT_EQ(result.repartitions, 1u);
    EXPECT_EQ(session->run(scene.frame(1)).repartitions, 0u) << "the deal holds: nothing went far";
}

/// Bodies that jump so far in every frame that no margin is of use: soon both devices have them all.
TEST_F(Shares, BodiesThatJumpAreEverybodys) {
    const auto scene = procession(12, 2, 40);
    const auto both = shared(algorithm("chunked"), scene);
    const auto one = alone(algorithm("chunked"), scene);
    for (std::size_t i = 0; i < 12; ++i) {
        const auto result = both->run(scene.frame(i % 2));
        expect_equal(result, one->run(scene.frame(i % 2)));
        if (i >= 6) {
            EXPECT_EQ(result.shared[0].bodies, 12u);
        }
    }
}

/// Pairs of bodies that are far from each other, which no deal has foreseen.
TEST_F(Shares, PairsThatAreGivenMayBeOfAnyBodies) {
    const auto scene = procession(10, 1, 0);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const auto both = shared(*traversal, scene);
        const auto one = alone(*traversal, scene);
        for (const auto& pairs :
             {std::vector<BodyPair>{{0, 9}, {3, 4}, {4, 5}, {2, 8}}, all_pairs(scene), {}})
            expect_equal(both->run(scene.frame(0), pairs), one->run(scene.frame(0), pairs));
        expect_equal(both->run(scene.frame(0)), one->run(scene.frame(0)));
    }
}

/// One body that moves, and one that does not: a device has nothing to do.
TEST_F(Shares, MoreDevicesThanBodies) {
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
        const auto result = shared(*traversal, scene)->run(scene.frame(0));
        ASSERT_GT(result.count, 0u);
        expect_equal(result, alone(*traversal, scene)->run(scene.frame(0)));
    }
}

/// Buffers with room for one row, and skipped tetrahedra, in shares.
TEST_F(Shares, RoomForOneAndTetrahedraLeftOut) {
    const auto scene = procession(8, 2, 0.3);
    for (const auto* traversal : algorithms()) {
        SCOPED_TRACE(traversal->name());
        const SettingTexts given{
            {"pair_capacity", "1"}, {"contact_capacity", "1"}, {"body_pair_capacity", "1"}};
        const auto both = shared(*traversal, scene, given);
        const auto one = alone(*traversal, scene);
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

/// A frame that is expected has room, and need not run twice.
TEST_F(Shares, ExpectedFramesRunOnce) {
    const auto scene = procession(8, 1, 0);
    const auto settings =
        settings_of(algorithm("tiled"), {{"pair_capacity", "1"}, {"contact_capacity", "1"}});
    const auto session = [&] {
        return ResidentSession(algorithm("tiled"), device("host"), scene,
                               algorithm("tiled").fitted(settings, device("host").info()));
    };
    auto surprised = session(), prepared = session();
    const auto frame = scene.frame(0);
    const auto result = surprised.run(frame);
    EXPECT_GT(result.retries, 0u);
    ASSERT_GT(result.contacts, 0u);
    prepared.expect(result.count, result.contacts_a_pair());
    const auto again = prepared.run(frame);
    EXPECT_EQ(again.retries, 0u);
    expect_equal(again, result);
    EXPECT_EQ(prepared.run(frame).retries, 0u) << "while the last answer is kept, with other buffers";
    // Buffers take turns where the last answer is kept.
    auto apart = frame;
    for (std::size_t body = 0; body < 8; ++body) {
        apart.poses[body].translation.x() = 100.0 * static_cast<double>(body);
        for (auto& vertex : apart.deformed[body]) vertex.x() += 100.0 * static_cast<double>(body);
    }
    auto later = session();
    auto last = later.run(apart);
    last = later.run(apart);
    ASSERT_EQ(last.count, 0u);
    last = later.run(frame);
    ASSERT_GT(last.retries, 0u);
    for (int i = 0; i < 4; ++i) {
        last = later.run(frame);
        EXPECT_EQ(last.retries, 0u) << "there was as much room before";
    }
}

/// Batches for want of memory look for their pairs among the share's alone, wherever they are found.
TEST_F(Shares, FramesInBatches) {
    const auto scene = procession(30, 1, 0);
    const auto one = alone(algorithm("tiled"), scene)->run(scene.frame(0));
    auto& little = device("opencl:0");
    // With room for some body pairs, and without: then the host finds them.
    for (const std::size_t left : {3'000u, 0u}) {
        const auto both =
            shared(algorithm("tiled"), scene,
                   {{"pair_capacity", "256"}, {"contact_capacity", "256"}, {"body_pair_capacity", "1"}});
        const std::vector<BodyPair> few{{2, 3}};
        both->run(scene.frame(0), few); // deals, and grows nothing that body pairs lie in
        little.set_memory_limit(little.bytes_allocated() + left);
        const auto result = both->run(scene.frame(0));
        little.set_memory_limit(Device::no_memory_limit);
        EXPECT_GT(result.batches, 2u);
        EXPECT_LE(result.body_pairs, BroadSweep(scene, {}, Broad::tight).pairs(scene.frame(0)).size())
            << "no pair is of two shares";
        EXPECT_EQ(result.count, one.count);
        EXPECT_EQ(result.digest(), one.digest());
        EXPECT_EQ(result.contact_digest(), one.contact_digest());
    }
}

/// A device that cannot go on says which it is; with memory again, the session goes on.
TEST_F(Shares, ADeviceThatFailsIsNamed) {
    const auto scene = procession(30, 2, 5);
    const auto both = shared(algorithm("tiled"), scene);
    const auto one = alone(algorithm("tiled"), scene);
    expect_equal(both->run(scene.frame(0)), one->run(scene.frame(0)));
    auto& little = device("opencl:0");
    little.set_memory_limit(1);
    std::string said;
    try {
        both->run(scene.frame(1));
    } catch (const OutOfMemory& error) {
        said = error.what();
    }
    little.set_memory_limit(Device::no_memory_limit);
    EXPECT_THAT(said, HasSubstr("opencl:0"));
    for (const std::size_t i : {1u, 0u}) expect_equal(both->run(scene.frame(i)), one->run(scene.frame(i)));
}

/// On the device, and of pairs that were brought to the host.
TEST_F(Shares, PairsAreCountedByBody) {
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
