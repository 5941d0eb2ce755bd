// SPDX-License-Identifier: MIT
// Frames that the host does not wait for (Session::enqueue): the answers of run(), a flag where these do not
// fit, and nothing written past the end then.
#include "tests/support/frames_there.h"
#include "tests/support/message_of.h"
#include "tests/support/on_device.h"
#include "tests/support/scenes.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

class Queued : public OnDevice {
protected:
    std::unique_ptr<Session> prepare(std::string_view name, const Scene& scene, const SettingTexts& given) {
        return prepare_on(on, algorithm(name), scene, given);
    }

    std::vector<std::uint32_t> words(const Buffer& from, std::size_t count) {
        std::vector<std::uint32_t> values(count);
        const StageScope scope(on, Stage::read);
        on.download(from, std::as_writable_bytes(std::span(values)));
        return values;
    }

    static void expect_equal(std::optional<FrameResult> result, const FrameResult& right) {
        ASSERT_TRUE(result);
        EXPECT_GT(right.count, 50u);
        EXPECT_EQ(result->count, right.count);
        EXPECT_EQ(result->digest(), right.digest());
        EXPECT_EQ(result->contacts, right.contacts);
        EXPECT_EQ(result->contact_digest(), right.contact_digest());
        EXPECT_EQ(result->download_contacts().size(), right.download_contacts().size());
    }
};

/// Whether the host takes part in an algorithm's walks.
bool needs_host(const Traversal& traversal) {
    return traversal.name() != "tiled" && traversal.name() != "chunked" && traversal.name() != "leaf_query";
}

TEST_P(Queued, FramesHaveTheAnswersOfRun) {
    const auto scene = crowd(3, 12, 1.5);
    for (const auto* traversal : walks()) {
        if (needs_host(*traversal)) continue;
        for (const auto& given : {SettingTexts{{"k", "18"}},
                                  {{"k", "8"}, {"precision", "double"}, {"decision", "recheck"}},
                                  {{"output", "digest"}},
                                  {{"order", "canonical"}, {"contact_rule", "none"}}}) {
            SCOPED_TRACE(fmt::format("{}{}", traversal->name(), text(given)));
            const auto right_session = prepare(traversal->name(), scene, given);
            const auto session = prepare(traversal->name(), scene, given);
            for (std::size_t i = 0; i < 4; ++i) {
                const Rows rows(scene.frame(i % scene.frame_count), i % 2 == 1);
                const auto right = right_session->run(rows.host);
                session->enqueue(rows.uploaded_to(on));
                expect_equal(session->collect(), right);
                session->enqueue(rows.host);
                expect_equal(session->collect(), right);
                session->enqueue(rows.host, all_pairs(scene));
                expect_equal(session->collect(), right_session->run(rows.host, all_pairs(scene)));
                if (i == 2) expect_equal(session->run(rows.host), right); // between frames that are enqueued
            }
        }
    }
}

/// What another library reads: ids of the pairs, contacts that name them by row, and counts.
TEST_P(Queued, RowsNameThePairs) {
    const auto scene = crowd(3, 12, 1.5);
    const auto session = prepare("tiled", scene, {});
    const Rows rows(scene.frame(0), false);
    const auto right = session->run(rows.uploaded_to(on));
    const auto frame = session->enqueue(rows.uploaded_to(on));
    const auto counts = words(frame.counts, QUEUED_WORDS);
    EXPECT_EQ(counts[QUEUED_FLAG], 0u);
    EXPECT_EQ(counts[QUEUED_PAIRS], right.count);
    EXPECT_EQ(counts[QUEUED_CONTACTS], right.contacts);
    EXPECT_EQ(counts[QUEUED_BODY_PAIRS], right.body_pairs);
    EXPECT_GE(frame.pair_capacity, right.count);
    std::vector<Pair> pairs;
    const auto ids = words(frame.pairs, 4 * right.count);
    for (std::size_t i = 0; i < ids.size(); i += 4)
        pairs.push_back({ids[i], ids[i + 1], ids[i + 2], ids[i + 3]});
    const auto features = words(frame.contact_ids, 2 * right.contacts);
    const auto values = words(frame.contact_values, 8 * right.contacts);
    auto contacts = right.download_contacts();
    ASSERT_EQ(contacts.size(), right.contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto found = std::ranges::find_if(contacts, [&](const ContactPoint& contact) {
            return contact.pair == pairs[features[2 * i]] && contact.feature == features[2 * i + 1];
        });
        ASSERT_NE(found, contacts.end());
        float numbers[8];
        std::memcpy(numbers, &values[8 * i], sizeof numbers);
        EXPECT_EQ(numbers[6], static_cast<float>(found->depth));
        EXPECT_NEAR(static_cast<double>(numbers[0]) + frame.origin[0], found->point[0], 1e-5);
        found->feature = ~0u; // each once
    }
    std::ranges::sort(pairs);
    EXPECT_EQ(pairs, right.download());
}

/// Buffers are guarded: the end of a session that writes past one throws.
TEST_P(Queued, FramesThatDoNotFitAreFlagged) {
    const auto scene = crowd(3, 12, 1.5);
    const Rows rows(scene.frame(0), false);
    on.guard_buffers();
    for (const std::string name : {"tiled", "chunked", "leaf_query"})
        for (const std::string capacity : {"pair_capacity", "contact_capacity", "body_pair_capacity"}) {
            SCOPED_TRACE(name + " " + capacity);
            const auto session = prepare(name, scene, {{capacity, "1"}, {"broad", "device"}});
            const auto frame = session->enqueue(rows.uploaded_to(on));
            EXPECT_FALSE(session->collect());
            EXPECT_EQ(words(frame.counts, 1)[0], std::uint32_t{QUEUED_NO_ROOM});
            on.check_guards();
            const auto right = session->run(rows.host); // grows the buffers
            EXPECT_GT(right.retries, 0u);
            EXPECT_THAT(message_of([&] { session->collect(); }), HasSubstr("call enqueue() first"));
            session->enqueue(rows.uploaded_to(on));
            expect_equal(session->collect(), right);
        }
}

/// Each kind of frame prepares itself, whatever came before, and later lists of body pairs may be longer.
TEST_P(Queued, EveryKindOfFrameMayFollowEveryOther) {
    const auto scene = crowd(3, 12, 1.5);
    const Rows rows(scene.frame(0), false);
    const auto device_frame = rows.uploaded_to(on);
    const auto pairs = all_pairs(scene);
    const auto other = prepare("chunked", scene, {});
    const auto right = other->run(rows.host);
    const auto right_few = other->run(rows.host, std::span(pairs).first(5));
    for (std::size_t first = 0; first < 5; ++first)
        for (std::size_t second = 0; second < 5; ++second) {
            SCOPED_TRACE(fmt::format("{} then {}", first, second));
            const auto session = prepare("chunked", scene, {{"broad", "tight"}, {"body_pair_capacity", "1"}});
            const auto enqueue = [&](std::size_t kind) {
                const auto given = std::span(pairs).first(kind == 4 ? 5 : pairs.size());
                const FrameView view = kind % 2 == 0 ? FrameView(rows.host) : FrameView(device_frame);
                kind < 2 ? session->enqueue(view) : session->enqueue(view, given);
                auto result = session->collect();
                if (!result) { // the pairs that the device finds do not fit into one row
                    EXPECT_EQ(kind, 1u);
                    session->run(view);
                    session->enqueue(view);
                    result = session->collect();
                }
                ASSERT_TRUE(result);
                EXPECT_EQ(result->digest(), (kind == 4 ? right_few : right).digest());
                EXPECT_EQ(result->contact_digest(), (kind == 4 ? right_few : right).contact_digest());
            };
            enqueue(first);
            enqueue(second);
        }
}

TEST_P(Queued, FlawedFramesAreFlaggedAndTheNextOneIsRight) {
    const auto scene = crowd(3, 12, 1.5);
    const auto session = prepare("tiled", scene, {});
    const Rows rows(scene.frame(0), false);
    auto flawed = rows;
    flawed.poses[7 * 3] = std::nan("");
    EXPECT_THAT(message_of([&] { session->collect(); }), HasSubstr("call enqueue() first"));
    EXPECT_THAT(message_of([&] { session->enqueue(flawed.uploaded_to(on)); }),
                HasSubstr("poses: row 3 is not finite"))
        << "the first call waits";
    EXPECT_THAT(message_of([&] { session->collect(); }), HasSubstr("call enqueue() first"));
    const auto right = session->run(rows.host);
    session->enqueue(rows.uploaded_to(on));
    const auto frame = session->enqueue(flawed.uploaded_to(on));
    EXPECT_FALSE(session->collect());
    EXPECT_EQ(words(frame.counts, 1)[0] & QUEUED_FLAWED, std::uint32_t{QUEUED_FLAWED});
    session->enqueue(rows.uploaded_to(on));
    expect_equal(session->collect(), right);
}

TEST_P(Queued, FramesThatNeedTheHostAreRefusedInOneLine) {
    const auto scene = crowd(3, 6, 1.5);
    const auto refusal = [&](std::string_view name, const SettingTexts& given) {
        const auto session = prepare(name, scene, given);
        return message_of([&] { session->enqueue(scene.frame(0)); });
    };
    EXPECT_THAT(refusal("gproximity", {}), HasSubstr("needs the host in every frame; choose tiled"));
    EXPECT_THAT(refusal("tiled", {{"decision", "exact"}}),
                HasSubstr("decision=exact decides some pairs on the host"));
    EXPECT_THAT(refusal("chunked", {{"residency", "published"}, {"broad", "sphere"}}),
                HasSubstr("residency=published waits in every frame"));
    const std::array both{&device("host"), &device("opencl:0")};
    const auto& tiled = algorithm("tiled");
    const auto split = tiled.prepare(both, scene, resolved(tiled));
    EXPECT_THAT(message_of([&] { split->enqueue(scene.frame(0)); }),
                HasSubstr("several devices share a frame"));
    EXPECT_THAT(message_of([&] { split->collect(); }), HasSubstr("call enqueue() first"));
}

/// An answer's memory outlives a session that replaces its buffers.
TEST_P(Queued, MemoryLivesAsLongAsTheFrame) {
    const auto scene = crowd(3, 12, 1.5);
    const auto session = prepare("tiled", scene, {{"pair_capacity", "1"}, {"tile_pair_capacity", "1"}});
    const Rows rows(scene.frame(0), false);
    const auto before = on.bytes_allocated();
    auto frame = session->enqueue(rows.uploaded_to(on));
    session->run(rows.host); // replaces them
    session->run(rows.host);
    const auto held = on.bytes_allocated();
    frame = {};
    EXPECT_LT(on.bytes_allocated(), held);
    EXPECT_GT(held, before);
}

TANDEM_ON_DEVICES(Queued);

} // namespace
} // namespace tandem
