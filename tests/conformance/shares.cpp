// SPDX-License-Identifier: MIT
// Sessions on several devices, each of which owns bodies: who needs what, deals that end, pairs that are
// given, and answers that are those of one device whatever happens.
#include "algorithms/resident_session.h"
#include "algorithms/shares/balance.h"
#include "algorithms/shares/deal.h"
#include "harness/reference.h"
#include "tests/support/cells.h"
#include "tests/support/scenes.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <set>

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
                deals += result.deals;
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
    EXPECT_EQ(result.deals, 1u);
    EXPECT_EQ(session->run(scene.frame(1)).deals, 0u) << "the deal holds: nothing went far";
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

TEST(Deals, EveryPairBelongsToOneShareThatHasBoth) {
    const auto scene = procession(40, 2, 0.05);
    for (const std::size_t count : {1u, 2u, 3u, 7u, 60u}) {
        Deal deal(scene, {}, count);
        EXPECT_FALSE(deal.holds(scene.frame(0)));
        deal.make(scene.frame(0), std::vector<double>(count, 1.0));
        EXPECT_TRUE(deal.holds(scene.frame(0)));
        std::multiset<std::uint32_t> owned;
        std::vector<std::vector<Role>> roles;
        for (const auto& share : deal.shares()) {
            owned.insert(share.own.begin(), share.own.end());
            roles.push_back(roles_in(share, scene.bodies.size()));
        }
        EXPECT_EQ(owned.size(), 39u) << "all but the fixed one, each once";
        EXPECT_EQ(std::set<std::uint32_t>(owned.begin(), owned.end()).size(), 39u);
        // Also of a later frame, as long as the deal holds.
        for (std::size_t i = 0; i < 2; ++i) {
            ASSERT_TRUE(deal.holds(scene.frame(i)));
            for (const auto& pair : BroadSweep(scene, {}, Broad::tight).pairs(scene.frame(i))) {
                std::size_t having = 0;
                for (const auto& of : roles)
                    having += of[pair.a] != Role::none && of[pair.b] != Role::none
                              && (of[pair.a] == Role::own || of[pair.b] == Role::own);
                EXPECT_EQ(having, 1u) << count << " shares, bodies " << pair.a << " and " << pair.b;
            }
        }
    }
}

TEST(Deals, EndWhenABodyGoesTooFar) {
    const auto scene = procession(10, 2, 0);
    Deal deal(scene, {}, 2);
    deal.make(scene.frame(0), std::array{1.0, 1.0});
    const auto holds_with = [&](std::uint32_t body, const auto& change) {
        auto frame = scene.frame(0);
        change(frame, body);
        return deal.holds(frame);
    };
    const auto push = [](double way) {
        return [way](Frame& frame, std::uint32_t body) { frame.poses[body].translation.x() += way; };
    };
    EXPECT_TRUE(holds_with(5, push(0.1)));
    EXPECT_FALSE(holds_with(5, push(0.4)));
    EXPECT_TRUE(holds_with(0, push(0.4))) << "a fixed one does not move, whatever a frame says";
    const auto turn = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].rotation =
            Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX())) * frame.poses[body].rotation;
    };
    EXPECT_FALSE(holds_with(5, turn));
    const auto stretch = [](Frame& frame, std::uint32_t body) { frame.deformed[body].back().z() += 1; };
    EXPECT_FALSE(holds_with(1, stretch));
    const auto lose = [](Frame& frame, std::uint32_t body) {
        frame.poses[body].translation.x() = std::numeric_limits<double>::quiet_NaN();
    };
    EXPECT_FALSE(holds_with(5, lose));
}

/// Work goes by speed, and by what was found where balls told wrong.
TEST(Deals, GoBySpeedAndByWhatWasFound) {
    const auto scene = procession(100, 1, 0);
    Deal deal(scene, {}, 2);
    deal.make(scene.frame(0), std::array{1.0, 1.0});
    EXPECT_NEAR(static_cast<double>(deal.shares()[0].own.size()), 49.5, 3);
    deal.make(scene.frame(0), std::array{3.0, 1.0});
    EXPECT_NEAR(static_cast<double>(deal.shares()[0].own.size()), 74.25, 3);
    EXPECT_EQ(deal.expected_pairs(0), 0u) << "balls alone say little of how many";
    std::vector<std::uint64_t> counts(100, 1000);
    std::fill(counts.begin(), counts.begin() + 50, 100'000);
    deal.learn(counts);
    deal.make(scene.frame(0), std::array{1.0, 1.0});
    const auto& owned = deal.shares()[0].own;
    const auto first = std::ranges::find(owned, 2u) != owned.end() ? owned.size() : 99 - owned.size();
    EXPECT_LT(first, 30u) << "half of the work is of the first fifty bodies";
    const auto expected = static_cast<double>(deal.expected_pairs(0) + deal.expected_pairs(1));
    const auto sum = static_cast<double>(std::accumulate(counts.begin(), counts.end(), 0ull));
    EXPECT_NEAR(expected / (sum / 2), 1, 0.1) << "each pair is counted at two bodies";
}

/// Bodies in whose pairs nothing is found: the first shares have to bound others' bodies as well as their
/// own.
TEST(Deals, CountWhatOthersBring) {
    Random random(3);
    Scene scene;
    scene.meshes = {shaken_box(1, random)};
    constexpr std::uint32_t side = 8;
    scene.bodies.resize(std::size_t{side} * side * side);
    const double apart = 1.6 * ball_around(scene.meshes[0].vertices).radius;
    Frame frame;
    for (std::uint32_t i = 0; i < side * side * side; ++i)
        frame.poses.push_back(
            {.translation = apart * Eigen::Vector3d(i % side, i / side % side, i / side / side)});
    frame.deformed.resize(scene.bodies.size());
    Deal deal(scene, {}, 4);
    deal.make(frame, std::array{1.0, 1.0, 1.0, 1.0});
    deal.learn(std::vector<std::uint64_t>(scene.bodies.size()));
    deal.make(frame, std::array{1.0, 1.0, 1.0, 1.0});
    std::size_t most = 0, sum = 0;
    for (const auto& share : deal.shares()) {
        most = std::max(most, share.own.size() + share.others.size());
        sum += share.own.size() + share.others.size();
    }
    EXPECT_GT(sum, scene.bodies.size() * 11 / 10);
    EXPECT_LT(static_cast<double>(most), 1.04 * static_cast<double>(sum) / 4);
}

SharedWork took(std::int64_t ns) { return {.bodies = 1, .body_pairs = 1, .pairs = 1, .ns = ns}; }

TEST(Balances, WantADealAfterSomeFramesOutOfBalance) {
    Balance balance(2);
    const std::array work{100.0, 100.0};
    const std::array even{took(100), took(104)}, odd{took(100), took(300)};
    EXPECT_DOUBLE_EQ(imbalance(odd), 1.5);
    balance.see(std::array{took(100), took(90'000)}, work);
    EXPECT_EQ(balance.speeds()[0], balance.speeds()[1]) << "devices may compile in the first frame";
    const std::array other{took(300), took(100)};
    for (int i = 0; i < 2; ++i)
        for (const auto& frame : {odd, other}) {
            EXPECT_FALSE(balance.wants_a_deal());
            balance.see(frame, work);
        }
    EXPECT_FALSE(balance.wants_a_deal()) << "now the one and now the other takes longer";
    balance.dealt();
    balance.see(even, work);
    for (int i = 0; i < 4; ++i) {
        EXPECT_FALSE(balance.wants_a_deal()) << "few frames say little";
        balance.see(odd, work);
    }
    EXPECT_TRUE(balance.wants_a_deal());
    EXPECT_NEAR(balance.speeds()[0] / balance.speeds()[1], 3, 1e-9);
    balance.dealt();
    EXPECT_FALSE(balance.wants_a_deal());
    // The deal was of no use: the next ones are asked for later and later.
    for (const std::size_t later : {4u, 8u, 16u}) {
        balance.see(even, work); // the first frame of a deal says nothing
        std::size_t frames = 0;
        while (!balance.wants_a_deal() && frames < 100) {
            balance.see(odd, work);
            ++frames;
        }
        EXPECT_EQ(frames, later) << "after one of no use";
        balance.dealt();
    }
}

/// Work is counted, and known after a frame; what speeds are takes longer.
TEST(Balances, WantADealAtOnceWhereWorkIsNotEven) {
    Balance balance(2);
    const std::array work{100.0, 120.0}, mended{110.0, 110.0};
    balance.see(std::array{took(100), took(100)}, work);
    EXPECT_TRUE(balance.wants_a_deal());
    EXPECT_EQ(balance.speeds()[0], balance.speeds()[1]);
    balance.dealt();
    for (int i = 0; i < 100; ++i) balance.see(std::array{took(110), took(110)}, mended);
    EXPECT_FALSE(balance.wants_a_deal());
}

/// The deal that speeds led to stays, although what is seen after it is even; a device without work is as
/// fast as it was.
TEST(Balances, StandByWhatTheyKnow) {
    Balance balance(3);
    const auto see = [&](std::size_t frames, std::array<double, 3> work,
                         const std::array<SharedWork, 3>& done) {
        for (std::size_t i = 0; i < frames; ++i) balance.see(done, work);
    };
    see(5, {100, 100, 100}, {took(100), took(125), took(100)});
    ASSERT_TRUE(balance.wants_a_deal());
    balance.dealt();
    const std::vector speeds(balance.speeds().begin(), balance.speeds().end());
    see(100, {107, 86, 107}, {took(107), took(108), took(107)});
    EXPECT_FALSE(balance.wants_a_deal());
    EXPECT_NEAR(balance.speeds()[1] / balance.speeds()[0], 0.8, 0.02);
    see(1000, {107, 0, 107}, {took(107), took(0), took(107)});
    EXPECT_NEAR(balance.speeds()[1] / balance.speeds()[0], 0.8, 0.02);
}

/// Frames whose times scatter by a tenth, and now and then by twice: no deal where shares are even, and one
/// where one takes longer.
TEST(Balances, DealForWhatIsSure) {
    std::mt19937 random(5);
    std::normal_distribution scatter(1.0, 0.1);
    const auto deals_in = [&](std::size_t frames, std::size_t shares, double first_takes) {
        const std::vector<double> work(shares, 1.0);
        Balance balance(shares);
        std::size_t deals = 0;
        for (std::size_t frame = 0; frame < frames; ++frame) {
            std::vector<SharedWork> done;
            for (std::size_t i = 0; i < shares; ++i) {
                const double hiccup = random() % 50 == 0 ? 2 : 1;
                done.push_back(
                    took(std::llround((i == 0 ? first_takes : 1) * 1e6 * scatter(random) * hiccup)));
            }
            balance.see(done, work);
            deals += balance.wants_a_deal() ? 1 : 0;
            if (balance.wants_a_deal()) balance.dealt();
        }
        return deals;
    };
    EXPECT_LE(deals_in(5000, 16, 1), 5u);
    EXPECT_LE(deals_in(5000, 2, 1), 5u);
    EXPECT_GE(deals_in(100, 16, 1.2), 1u);
    EXPECT_GE(deals_in(100, 2, 1.2), 1u);
}

} // namespace
} // namespace tandem
