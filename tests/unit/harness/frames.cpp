// SPDX-License-Identifier: MIT
// Frames of a range: stored if they fit, generated again if not, with the same answers.
#include "harness/frames/frames.h"

#include "harness/verify/accuracy/answer_errors_json.h"
#include "harness/choosing/choose.h"
#include "harness/sampling/local_sampler.h"
#include "base/parallel.h"
#include "tests/support/cells.h"
#include "tests/support/flawed.h"
#include "tests/support/heap.h"
#include "tests/support/test.h"

#include <atomic>
#include <thread>

namespace tandem {
namespace {

using namespace support;

constexpr std::size_t frame_count = 24;
constexpr std::size_t idle_vertices = 40000; ///< vertices of no tetrahedron: memory without work
constexpr std::size_t idle_bytes = idle_vertices * sizeof(Eigen::Vector3d);

/// Three boxes, one of them deformable with a megabyte a frame; one mesh and some frames have flat
/// tetrahedra. Counts generated frames and the memory in use at each.
class FrameRanges : public testing::Test {
protected:
    FrameRanges() {
        scene_ = boxes_scene(2, frame_count);
        make_flat(scene_.meshes[0], scene_.meshes[0].vertices, 3);
        auto& mesh = scene_.meshes[1];
        mesh.vertices.resize(mesh.vertices.size() + idle_vertices, mesh.vertices.front());
        scene_.frame = [this, light = scene_.frame, mesh](std::size_t i) {
            ++made_;
            most_ = std::max(most_, heap());
            auto frame = light(i);
            auto& vertices = frame.deformed[2];
            vertices.resize(mesh.vertices.size(), vertices.front());
            if (i % 3 == 1) make_flat(mesh, vertices, static_cast<std::uint32_t>(i));
            return frame;
        };
    }

    std::vector<std::uint64_t> digests() const {
        std::vector<std::uint64_t> all;
        for (std::size_t i = 0; i < frame_count; ++i) all.push_back(digest_of(scene_.frame(i)));
        return all;
    }

    Scene scene_;
    std::atomic<std::size_t> made_ = 0;
    std::size_t most_ = 0;
};

TEST_F(FrameRanges, ThatFitAreGeneratedOnce) {
    const FrameRange range(scene_, 2, 9);
    EXPECT_EQ(range.size(), 8u);
    const auto first = range.frame(0);
    for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(range.frame(i % 8)->poses.size(), 3u);
    EXPECT_EQ(range.frame(0), first);
    EXPECT_EQ(made_, 8u);
    EXPECT_EQ(digest_of(*range.frame(5)), digest_of(scene_.frame(7)));
}

TEST_F(FrameRanges, ThatDoNotFitAreRegeneratedAndReleased) {
    const auto expected = digests();
    made_ = 0;
    const FrameRange range(scene_, 0, frame_count - 1, Degenerate::flat, 3 * idle_bytes);
    EXPECT_EQ(made_, frame_count);
    std::vector<std::weak_ptr<const Frame>> all;
    for (std::size_t i = 0; i < 2 * frame_count; ++i) {
        all.push_back(range.frame(i % frame_count));
        EXPECT_EQ(digest_of(*range.frame(i % frame_count)), expected[i % frame_count]) << i;
        EXPECT_EQ(std::ranges::count_if(all, [](const auto& frame) { return !frame.expired(); }), 1);
    }
    EXPECT_EQ(made_, 3 * frame_count) << "the last requested frame stays in memory";
}

/// Frames in use stay valid while others are requested.
TEST_F(FrameRanges, StayValidWhileInUse) {
    const auto expected = digests();
    const FrameRange range(scene_, 0, frame_count - 1, Degenerate::flat, 0);
    const auto fifth = range.frame(5), second = range.frame(2);
    for (std::size_t i = 0; i < frame_count; ++i) range.frame(i);
    EXPECT_EQ(digest_of(*fifth), expected[5]);
    EXPECT_EQ(digest_of(*second), expected[2]);
}

TEST_F(FrameRanges, ServeAnyNumberOfThreads) {
    const auto expected = digests();
    const FrameRange range(scene_, 0, frame_count - 1, Degenerate::flat, 0);
    std::atomic<std::size_t> right = 0;
    parallel_for(frame_count * 4, 4, [&](std::size_t i) {
        const auto index = i * 7 % frame_count;
        right += digest_of(*range.frame(index)) == expected[index] ? 1 : 0;
    });
    EXPECT_EQ(right, frame_count * 4);
}

/// The smallest budget that stores three frames.
std::uint64_t least_budget(const Scene& scene, Degenerate handling) {
    std::uint64_t least = 1, most = 1 << 20;
    while (least < most) {
        const auto middle = (least + most) / 2;
        const FrameRange range(scene, 0, 2, handling, middle);
        const auto first = range.frame(0);
        range.frame(1);
        (range.frame(0) == first ? most : least) = range.frame(0) == first ? middle : middle + 1;
    }
    return least;
}

TEST(FrameBudget, CoversAllFramesAndTheirLists) {
    auto scene = boxes_scene(2, 3);
    const auto vertices = 3 * scene.meshes[1].vertices.size() * sizeof(Eigen::Vector3d);
    const auto least = least_budget(scene, Degenerate::skip);
    EXPECT_GT(least, vertices);
    EXPECT_LT(least, vertices + 2000);
    make_flat(scene.meshes[0], scene.meshes[0].vertices, 3);
    const auto flat = FrameRange(scene, 0, 2).flaws().degenerate;
    ASSERT_GE(flat, 6u);
    EXPECT_EQ(least_budget(scene, Degenerate::flat), least);
    EXPECT_EQ(least_budget(scene, Degenerate::skip), least + 4 * flat);
}

/// All consumers of frames, one after the other.
struct Answers {
    std::vector<Digest> expected, sampled;
    nlohmann::json errors;
    std::map<std::string_view, std::uint64_t> work;
    std::string flaws;
    std::size_t events = 0;

    bool operator==(const Answers&) const = default;
};

Cell host_cell() {
    const auto& tiled = algorithm("tiled");
    return make_cell(tiled, tiled.presets().front(),
                     {{"k", "8"}, {"pair_capacity", "16384"}, {"contact_capacity", "16384"}},
                     {&device("host")});
}

Answers answers(const Scene& scene, const FrameRange& range) {
    Answers all;
    const auto cell = host_cell();
    all.flaws = describe(range.flaws(), scene);
    References references(scene, range);
    for (auto i = range.size(); i-- > 0;) // from the last to the first, to vary the order
        all.expected.push_back(references.digests(geometry_of(cell.settings), {}, i).pairs);
    Truths truths(scene, range, TruthAmount::pairs, 0);
    LocalSampler sampler(cell, scene, range, references);
    sampler.check({.truths = &truths});
    sampler.round(2);
    sampler.count_work();
    EXPECT_TRUE(sampler.measurement().agreement.ok());
    all.sampled = sampler.state().digests;
    all.errors = *sampler.measurement().errors;
    all.work = sampler.measurement().work;
    for (const auto& trace : Replays(cell, scene, range).traced(range.size() / 2))
        all.events += trace.events.size();
    return all;
}

TEST_F(FrameRanges, GiveTheSameAnswersInMemoryThatDoesNotGrowWithThem) {
    constexpr auto budget = 2 * idle_bytes;
    for (const auto handling : {Degenerate::flat, Degenerate::skip}) {
        most_ = 0;
        answers(scene_, FrameRange(scene_, 0, frame_count / 4 - 1, handling, budget));
        const auto of_a_quarter = most_;
        const auto streamed = answers(scene_, FrameRange(scene_, 0, frame_count - 1, handling, budget));
        EXPECT_LT(most_, of_a_quarter + 3 * idle_bytes) << name_of(handling);
        const auto stored = answers(scene_, FrameRange(scene_, 0, frame_count - 1, handling));
        EXPECT_EQ(streamed, stored) << name_of(handling);
        EXPECT_GT(stored.expected[0].count, 100u);
        EXPECT_NE(stored.sampled.front(), stored.sampled.back())
            << "frames differ, so a stale one is detected";
    }
}

/// Each frame takes a tenth of a second to generate, and a small fraction of that to search.
TEST(FrameTimes, ExcludeTheGenerationOfFrames) {
    static constexpr std::int64_t making_ns = 100'000'000;
    auto scene = boxes_scene(2, 2);
    scene.frame = [quick = scene.frame](std::size_t i) {
        std::this_thread::sleep_for(std::chrono::nanoseconds(making_ns));
        return quick(i);
    };
    const FrameRange range(scene, 0, 1, Degenerate::flat, 0);
    const auto cell = host_cell();
    Replays replays(cell, scene, range);
    replays.counted(); // grows the buffers in the first replay
    for (const auto ns : replays.timed([](std::size_t, const FrameResult&) {}).frame_ns)
        EXPECT_LT(ns, making_ns);
    for (const auto ns : replays.instrumented().frame_ns) EXPECT_LT(ns, making_ns);
    auto chosen = cell;
    chosen.candidates = {cell};
    choose(chosen, scene, range, {.seconds = 0, .folder = {}});
    EXPECT_LT((*chosen.chosen)["seconds"].get<double>() * 1e9, making_ns);
}

} // namespace
} // namespace tandem
