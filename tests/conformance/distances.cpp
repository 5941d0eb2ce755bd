// SPDX-License-Identifier: MIT
// contact_rule=distance and output=distances: by every algorithm the rows of the reference; no pair of
// boundary tetrahedra within the margin lacks its row, measured in double from the scene's own vertices; and
// of each body pair the least distance, under any order, capacity, limit of memory and number of devices.
#include "tests/support/distances.h"
#include "tests/support/limited.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

constexpr double most_distance = 0.2;

SettingTexts measuring(SettingTexts given = {}) {
    given.merge(SettingTexts{{"contact_rule", "distance"}, {"margin", fmt::format("{}", most_distance)}});
    return given;
}

/// Of contacts in ascending order of pairs, those that output=distances keeps.
std::vector<ContactPoint> closest_of(const std::vector<ContactPoint>& all) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, ContactPoint> closest;
    for (const auto& one : all) {
        const auto [best, is_first] = closest.try_emplace({one.pair.body_a, one.pair.body_b}, one);
        if (!is_first && one.depth < best->second.depth) best->second = one;
    }
    std::vector<ContactPoint> result;
    for (const auto& [bodies, one] : closest) result.push_back(one);
    std::ranges::sort(result, {}, &ContactPoint::pair);
    return result;
}

void expect_equal(const std::vector<ContactPoint>& found, const std::vector<ContactPoint>& right) {
    ASSERT_EQ(found.size(), right.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].pair, right[i].pair);
        EXPECT_EQ(found[i].feature, right[i].feature);
        EXPECT_EQ(found[i].point, right[i].point);
        EXPECT_EQ(found[i].normal, right[i].normal);
        EXPECT_EQ(found[i].depth, right[i].depth);
    }
}

class DistancesOf : public OnDevice {
protected:
    bool is_at_boundary(std::uint32_t body, std::uint32_t number) const {
        return scene_.meshes[scene_.bodies[body].mesh].boundary[number] != 0;
    }

    Scene scene_ = crowd(21, 8, 2);
    Frame frame_ = scene_.frame(0);
};

TEST_P(DistancesOf, EveryAlgorithmHasTheRowsOfTheReference) {
    std::vector<SettingTexts> cells{{}, {{"output", "distances"}, {"order", "canonical"}}};
    if (walks().size() > 2) {
        cells.push_back({{"output", "distances"}, {"precision", "double"}, {"k", "6"}});
        cells.push_back({{"output", "contacts"}, {"self", "deformable"}, {"decision", "exact"}});
        cells.push_back({{"output", "distances"}, {"pair_layout", "items"}, {"decision", "fp32"}});
    }
    for (const auto* traversal : walks())
        for (const auto& cell : cells) {
            const auto given = measuring(cell);
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto session = prepare(*traversal, scene_, given);
            const auto right = reference(scene_, frame_, geometry_of(session->settings()), true,
                                         Method::brute_force, contact_settings_of(session->settings()));
            const auto result = session->run(frame_);
            EXPECT_EQ(result.digest(), right.digest);
            EXPECT_EQ(result.contact_digest(), right.contact_digest);
            EXPECT_EQ(result.contacts, right.contacts);
            EXPECT_GT(result.contacts, 5u);
        }
}

TEST_P(DistancesOf, EveryBoundaryPairWithinTheMarginHasItsRow) {
    const auto& traversal = algorithm("tiled");
    const auto rows = prepare(traversal, scene_, measuring())->run(frame_).download_contacts();
    std::map<Pair, ContactPoint> by_pair;
    for (const auto& row : rows) EXPECT_TRUE(by_pair.try_emplace(row.pair, row).second) << "one row a pair";
    std::size_t apart = 0;
    for (std::uint32_t a = 0; a < scene_.bodies.size(); ++a)
        for (std::uint32_t b = a + 1; b < scene_.bodies.size(); ++b)
            for (std::uint32_t i = 0; i < scene_.meshes[scene_.bodies[a].mesh].tetrahedra.size(); ++i)
                for (std::uint32_t j = 0; j < scene_.meshes[scene_.bodies[b].mesh].tetrahedra.size(); ++j) {
                    if (!is_at_boundary(a, i) || !is_at_boundary(b, j)) continue;
                    const auto distance = distance_between<double>(corners_of(scene_, frame_, a, i),
                                                                   corners_of(scene_, frame_, b, j));
                    const auto row = by_pair.find({a, i, b, j});
                    if (distance <= most_distance - 1e-5) { // vertices are rounded
                        ASSERT_NE(row, by_pair.end()) << a << ' ' << i << ' ' << b << ' ' << j;
                    }
                    if (row == by_pair.end() || row->second.depth <= 0) continue; // those that meet
                    EXPECT_NEAR(row->second.depth, distance, 1e-5);
                    EXPECT_LE(row->second.depth, most_distance + 1e-5);
                    ++apart;
                }
    EXPECT_GT(apart, 1000u);
}

TEST_P(DistancesOf, OfEachBodyPairTheLeastStays) {
    const auto& traversal = algorithm("tiled");
    const auto all = prepare(traversal, scene_, measuring())->run(frame_);
    const auto right = closest_of(all.download_contacts());
    ASSERT_GT(right.size(), 4u);
    for (const SettingTexts& cell : {SettingTexts{}, SettingTexts{{"order", "canonical"}},
                                     SettingTexts{{"order", "canonical"},
                                                  {"pair_capacity", "1"},
                                                  {"contact_capacity", "1"},
                                                  {"body_pair_capacity", "1"},
                                                  {"broad", "device"}}}) {
        auto given = measuring(cell);
        given["output"] = "distances";
        SCOPED_TRACE(text(given));
        const auto session = prepare(traversal, scene_, given);
        for (int turn = 0; turn < 2; ++turn) {
            const auto result = session->run(frame_);
            EXPECT_EQ(result.contacts, right.size());
            expect_equal(result.download_contacts(), right);
        }
    }
}

/// Each part of the frame has rows of the same body pairs; rows are made in ranges, some without pairs that
/// meet.
TEST_P(DistancesOf, BatchesHaveTheSameRows) {
    const auto scene = procession(12, 2, 0.02);
    auto frame = scene.frame(1);
    for (std::size_t body = 0; body < frame.poses.size(); ++body)
        frame.poses[body].translation.x() += 3.0 * static_cast<double>(body);
    // Each session in batches compiles kernels of its own, which takes seconds on a processor with OpenCL.
    const bool few = !long_form() && GetParam() != "host";
    const std::vector<double> factors = few ? std::vector{1.2} : std::vector{1.05, 1.2, 1.5, 2.0, 3.0};
    for (const std::string output : {"distances", "pairs"})
        for (const auto* traversal : few ? std::vector{&algorithm("tiled")} : walks()) {
            const SettingTexts given{{"contact_rule", "distance"},
                                     {"margin", "3.5"},
                                     {"output", output},
                                     {"pair_capacity", "500"},
                                     {"contact_capacity", "50"}};
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto whole = prepare(*traversal, scene, given)->run(frame);
            EXPECT_LT(whole.count - whole.rejected - whole.without_boundary, whole.count / 100) << "few meet";
            const Answer right(whole);
            const auto least = least_bytes(on, *traversal, scene, given);
            std::size_t in_batches = 0;
            for (const double factor : factors) {
                const Limited limited(on, static_cast<std::size_t>(factor * static_cast<double>(least)));
                try {
                    const auto session = prepare(*traversal, scene, given);
                    const auto result = session->run(frame);
                    in_batches += result.batches > 1 ? 1 : 0;
                    EXPECT_EQ(Answer(result), right) << factor;
                    EXPECT_EQ(Answer(session->run(frame)), right) << factor;
                } catch (const OutOfMemory&) {}
            }
            if (traversal->name() == "tiled") {
                EXPECT_GT(in_batches, 0u);
            }
        }
}

TEST_P(DistancesOf, TwoDevicesHaveTheSameRows) {
    const auto scene = procession(12, 2, 0.02);
    const auto frame = scene.frame(1);
    const auto& tiled = algorithm("tiled");
    const auto settings =
        resolved(tiled, {{"contact_rule", "distance"}, {"margin", "0.5"}, {"output", "distances"}});
    const auto one = prepare_on(on, tiled, scene, settings)->run(frame);
    ASSERT_GT(one.contacts, 10u);
    const std::array both{&device("host"), &device("opencl:0")};
    const auto two = tiled.prepare(both, scene, settings)->run(frame);
    EXPECT_EQ(two.contacts, one.contacts);
    EXPECT_EQ(two.contact_digest(), one.contact_digest());
}

TEST_P(DistancesOf, ImpossibleSettingsAreRefused) {
    const auto& chunked = algorithm("chunked");
    const auto refusal = [&](SettingTexts given) {
        return message_of([&] { prepare(chunked, scene_, given); });
    };
    EXPECT_THAT(refusal(measuring({{"motion", "linear"}, {"decision", "exact"}})),
                HasSubstr("motion=linear does not go with contact_rule=distance"));
    EXPECT_THAT(refusal(measuring({{"decision", "none"}})),
                HasSubstr("decision=none does not go with contact_rule=distance"));
    EXPECT_THAT(refusal({{"output", "distances"}, {"contact_rule", "sat"}}),
                HasSubstr("output=distances needs contact_rule=distance"));
    EXPECT_THAT(refusal({{"output", "distances"}, {"contact_rule", "distance"}, {"residency", "published"}}),
                HasSubstr("output=distances does not go with residency=published"));
}

TANDEM_ON_DEVICES(DistancesOf);

} // namespace
} // namespace tandem
