// SPDX-License-Identifier: MIT
// Frames that do not fit into memory, and allocations that fail. The answer in batches is the same, and a
// session that ran out of memory can be used again.
#include "tests/support/flawed.h"
#include "tests/support/limited.h"
#include "tests/support/long_form.h"
#include "tests/support/message_of.h"
#include "tests/support/scenes.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using ::testing::HasSubstr;

class Batches : public OnDevice {
protected:
    static void expect_equal(const FrameResult& result, const ReferenceAnswer& right) {
        EXPECT_EQ(result.count, right.digest.count);
        EXPECT_EQ(result.contacts, right.contacts);
        expect_same_digests(result, right);
        EXPECT_EQ(result.download(), right.pairs);
        EXPECT_EQ(result.degenerate, right.degenerate);
        EXPECT_EQ(result.without_boundary, right.without_boundary);
        EXPECT_EQ(result.rejected, right.rejected);
        EXPECT_EQ(result.undecided_by_filter, right.undecided_by_filter);
        EXPECT_EQ(result.undecided_by_double, right.undecided_by_double);
        const auto contacts = result.download_contacts();
        EXPECT_EQ(contacts.size(), right.contacts);
        EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
            return std::tie(a.pair, a.feature) < std::tie(b.pair, b.feature);
        }));
    }
};

/// Several body pairs, with every decision, by all algorithms; memory is less than pairs and contacts need.
TEST_P(Batches, GiveTheSameAnswerLong) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(71, 10, 0.9);
    std::size_t cell = 0;
    for (const auto* traversal : algorithms()) {
        for (const std::string decision : {"fp32", "recheck", "exact"}) {
            for (const std::string precision : {"float", "double"}) {
                // The short form tests each decision in one precision; the other precision follows with the
                // next algorithm.
                if (!long_form() && cell++ % 2 != 0) continue;
                const SettingTexts given{
                    {"decision", decision}, {"precision", precision}, {"contact_rule", "sat"}, {"k", "8"}};
                SCOPED_TRACE(std::string(traversal->name()) + text(given));
                const auto frame = scene.frame(0);
                const auto settings = resolved(*traversal, given);
                const auto right = reference(scene, frame, geometry_of(settings), true, Method::brute_force,
                                             contact_settings_of(settings));
                const auto wanted = 16 * right.digest.count + 72 * right.contacts;
                const Limited limit(on, least_bytes(on, *traversal, scene, given) + wanted / 10);
                const auto session = prepare(*traversal, scene, given);
                const auto result = session->run(frame);
                EXPECT_GT(result.batches, 1u);
                expect_equal(result, right);
                // starts with the number of batches of the first run
                expect_equal(session->run(frame), right);
                session->reset();
                expect_equal(session->run(frame), right);
            }
            ++cell;
        }
    }
}

/// The paper's data path with too many seeds and pairs: batches of body pairs and, with less memory, of one
/// body pair.
TEST_P(Batches, GiveTheSameAnswerOnThePapersDataPath) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(72, 10, 0.9);
    for (const auto* traversal : algorithms()) {
        if (!declares(*traversal, "residency")) continue;
        for (const double fraction : {0.5, 0.1}) {
            const SettingTexts given{{"residency", "published"}, {"broad", "sphere"}, {"k", "8"}};
            SCOPED_TRACE(fmt::format("{} {}", traversal->name(), fraction));
            const auto frame = scene.frame(0);
            const auto settings = resolved(*traversal, given);
            const auto right = reference(scene, frame, geometry_of(settings), true, Method::brute_force,
                                         contact_settings_of(settings));
            const auto wanted = 16 * right.digest.count + 72 * right.contacts;
            const Limited limit(on, least_bytes(on, *traversal, scene, given)
                                        + static_cast<std::size_t>(fraction * static_cast<double>(wanted)));
            const auto session = prepare(*traversal, scene, given);
            const auto result = session->run(frame);
            EXPECT_GT(result.batches, 1u);
            expect_equal(result, right);
            expect_equal(session->run(frame), right);
        }
    }
}

/// A single body pair is split by its items. The digest and the count are summed during traversal and need no
/// pairs.
TEST_P(Batches, SplitABodyPairByItems) {
    auto scene = boxes_scene(7, 2); // the first two bodies are used
    auto frame = scene.frame(0);
    scene.bodies.pop_back();
    frame.poses.pop_back();
    frame.deformed.pop_back();
    const auto right = reference(scene, frame, {}, true, Method::sweep);
    ASSERT_GT(right.digest.count, 2000u);
    const BodyPair only{0, 1};
    for (const auto* traversal : walks())
        for (const SettingTexts& more :
             {SettingTexts{}, SettingTexts{{"leaves", "2"}, {"seed_threshold", "1"}, {"seed_capacity", "1"}},
              SettingTexts{{"leaves", "2"}, {"seed_threshold", "1"}, {"schedule", "item"}}}) {
            if (traversal->name() != "chunked" && !more.empty()) continue;
            SCOPED_TRACE(std::string(traversal->name()) + text(more));
            const Limited limit(on, least_bytes(on, *traversal, scene, more) + 8 * right.digest.count);
            const auto session = prepare(*traversal, scene, more);
            const auto result = session->run(frame, {&only, 1});
            EXPECT_GT(result.batches, 1u);
            expect_equal(result, right);
        }
}

TEST_P(Batches, AnErrorBelowTheMinimumNamesTheNeededBytes) {
    const auto scene = crowd(72, 5, 0.9);
    for (const auto* traversal : algorithms()) {
        const Limited limit(on, 5000);
        try {
            prepare(*traversal, scene, {});
            FAIL();
        } catch (const OutOfMemory& error) {
            EXPECT_THAT(error.what(), HasSubstr("bodies and hierarchy of scene"));
            EXPECT_THAT(error.what(),
                        HasSubstr(fmt::format("the limit of its memory is {}", on.memory_limit())));
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
        // the failed prepare() has released its memory
        EXPECT_EQ(on.bytes_allocated() + 5000, on.memory_limit());
    }
}

/// Too little memory for the lists between the contact stage's kernels: the stage runs several rounds in one
/// batch, and each round starts with empty lists.
TEST_P(Batches, ContactsRunInRoundsWhenTheirListsAreShort) {
    auto scene = boxes_scene(7, 2);
    const auto frame = scene.frame(0);
    const auto& traversal = algorithm("tiled");
    for (const std::string rule : {"opposing", "sat"}) {
        if (compiles_briefly() && rule == "sat") continue;
        const auto settings = resolved(traversal, {{"contact_rule", rule}});
        const auto right = reference(scene, frame, {}, true, Method::sweep, contact_settings_of(settings));
        const auto pairs = right.digest.count;
        ASSERT_GT(pairs, 4000u); // the stage never uses rounds of 1,024 pairs or fewer
        ASSERT_GT(right.contacts, 0u);
        const auto session = prepare(traversal, scene,
                                     {{"contact_rule", rule},
                                      {"pair_capacity", std::to_string(pairs)},
                                      {"contact_capacity", std::to_string(right.contacts)}});
        constexpr std::uint64_t word = 4, lists = 2;
        const Limited limit(on, pairs * word * lists / 3); // memory for a quarter of the pairs
        for (int run = 0; run < 2; ++run) {
            on.set_clocks(Clocks::on);
            const auto result = session->run(frame);
            const auto trace = on.finish();
            on.set_clocks(Clocks::off);
            EXPECT_EQ(result.batches, 1u);
            EXPECT_EQ(result.retries, 0u);
            // From the second run on, a GPU uses one round because the first run found few remaining pairs.
            if (run == 0 || !on.info().is_gpu) {
                EXPECT_GE(std::ranges::count(trace.events, "separate_pairs", &Event::label), 4);
            }
            expect_equal(result, right);
        }
    }
}

/// No memory beyond what is allocated: the run fails. The next run, with memory, is correct.
TEST_P(Batches, ASessionWithoutMemoryCanBeUsedAgain) {
    TANDEM_LONG_FORM_ONLY(GetParam());
    const auto scene = crowd(73, 2, 0.4);
    const auto frame = scene.frame(0);
    const auto right = reference(scene, frame, {}, true, Method::brute_force);
    for (const auto* traversal : algorithms())
        for (auto given : residencies_of(*traversal)) {
            given.insert({{"pair_capacity", "1"}, {"contact_capacity", "1"}, {"decision", "exact"}});
            SCOPED_TRACE(std::string(traversal->name()) + text(given));
            const auto session = prepare(*traversal, scene, given);
            for (int i = 0; i < 2; ++i) {
                const Limited limit(on, 0);
                try {
                    expect_equal(session->run(frame), right); // in batches of the existing capacities
                } catch (const OutOfMemory&) {}
            }
            auto expected = reference(scene, frame, {}, true, Method::brute_force,
                                      {ContactRule::opposing, DecisionPrecision::exact});
            expect_equal(session->run(frame), expected);
        }
}

/// A result owns its answer: later runs do not change it, and need no memory after its release.
TEST_P(Batches, AnAnswerOutlivesTheNextRuns) {
    const auto scene = crowd(74, 8, 0.8);
    for (const auto* traversal : walks())
        for (const auto& given : residencies_of(*traversal)) {
            const auto session = prepare(*traversal, scene, given);
            std::vector<ReferenceAnswer> right;
            for (std::size_t i = 0; i < 2; ++i)
                right.push_back(reference(scene, scene.frame(i), {}, true, Method::brute_force));
            ASSERT_NE(right[0].digest, right[1].digest);
            std::vector<FrameResult> results;
            for (std::size_t i = 0; i < 4; ++i) results.push_back(session->run(scene.frame(i % 2)));
            for (std::size_t i = 0; i < 4; ++i) expect_equal(results[i], right[i % 2]);
            const auto bytes = on.bytes_allocated();
            results.clear();
            for (std::size_t i = 0; i < 4; ++i) session->run(scene.frame(i % 2));
            EXPECT_EQ(on.bytes_allocated(), bytes);
        }
}

TANDEM_ON_DEVICES(Batches);

/// One cell on several devices, one of them twice.
class Split : public testing::Test {
protected:
    static std::unique_ptr<Session> prepare(const Traversal& traversal, const Scene& scene,
                                            const SettingTexts& given) {
        const std::array devices{&device("host"), &device("opencl:0")};
        return traversal.prepare(devices, scene, resolved(traversal, given));
    }
};

TEST_F(Split, PartsAddUpOnlyLong) {
    const auto scene = crowd(75, 9, 0.9);
    for (const auto* traversal : algorithms())
        for (const std::string output : {"pairs", "digest", "count"})
            for (const std::string broad : {"device", "sphere"}) {
                SCOPED_TRACE(fmt::format("{} {} {}", traversal->name(), output, broad));
                const auto session = prepare(*traversal, scene, {{"output", output}, {"broad", broad}});
                EXPECT_EQ(session->devices().size(), 2u);
                for (std::size_t i = 0; i < 2; ++i) {
                    const auto right = reference(scene, scene.frame(i), {}, true, Method::brute_force);
                    const auto result = session->run(scene.frame(i));
                    EXPECT_EQ(result.count, right.digest.count);
                    if (output != "count") {
                        EXPECT_EQ(result.digest(), right.digest);
                    }
                    if (output != "pairs") continue;
                    EXPECT_EQ(result.parts.size(), 2u);
                    EXPECT_EQ(result.download(), right.pairs);
                    EXPECT_EQ(result.contact_digest(), right.contact_digest);
                    EXPECT_EQ(result.parts[0]->pairs().count + result.parts[1]->pairs().count, result.count);
                }
            }
}

TEST_F(Split, ThePapersDataPathNeedsASingleDevice) {
    const auto scene = crowd(76, 3, 0.9);
    for (const auto* traversal : algorithms()) {
        if (!declares(*traversal, "residency")) continue;
        EXPECT_THAT(message_of([&] {
                        prepare(*traversal, scene, {{"residency", "published"}});
                    }),
                    HasSubstr("cannot split a frame between host + opencl:0"));
    }
}

TEST_F(Split, CountsOfWorkAddUp) {
    const auto scene = crowd(77, 9, 0.9);
    const auto& traversal = algorithm("chunked");
    const SettingTexts given{{"broad", "sphere"}, {"seed_threshold", "1e7"}};
    const auto both = prepare(traversal, scene, given);
    const std::array one{&device("host")};
    const auto alone = traversal.prepare(one, scene, resolved(traversal, given));
    both->count_work(true);
    alone->count_work(true);
    const auto frame = scene.frame(0);
    EXPECT_EQ(both->run(frame).work, alone->run(frame).work);
}

} // namespace
} // namespace tandem
