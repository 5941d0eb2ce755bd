// SPDX-License-Identifier: MIT
#include "harness/frames/frames.h"
#include "tests/support/folder.h"
#include "tests/support/recordings.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;
using testing::MatchesRegex;

class RecordingScene : public FolderTest {
protected:
    /// Records frames of a pile, starting at the pile's frame `first`.
    static void record(const std::string& file, const std::string& specification, std::size_t first,
                       std::size_t frames, const MeshReading& reading = {}) {
        const auto scene = make_scene(specification, reading);
        auto writer = RecordingWriter::create(file, recording_of(specification, scene, 0.25));
        for (std::size_t i = 0; i < frames; ++i)
            writer.append(i, 0.25 * static_cast<double>(i), scene.frame(first + i));
    }
    std::string description(const std::string& position) const {
        write_bytes(path("two.json"), R"({"frames": 4, "meshes": {"j": {"builtin": "jack"}}, "bodies": [
            {"mesh": "j", "fixed": true, "position": )"
                                          + position + R"(}, {"mesh": "j", "spin": [0, 0, 1, 0.1]}]})");
        return path("two.json");
    }

    std::string file_ = path("drift.frames");
};

TEST_F(RecordingScene, HasTheRecordedFrames) {
    record(file_, "pile:bodies=3,frames=9", 2, 5);
    const auto pile = make_scene("pile:bodies=3,frames=9");
    const auto scene = make_scene(file_);
    EXPECT_EQ(scene.name, "drift");
    EXPECT_THAT(scene.key,
                MatchesRegex("recording:drift,frames=5,digest=[0-9a-f]+,of=pile:bodies=3,.*frames=9.*"));
    ASSERT_EQ(scene.frame_count, 5u);
    ASSERT_EQ(scene.bodies.size(), 3u);
    EXPECT_EQ(scene.meshes[0].tetrahedra, pile.meshes[0].tetrahedra);
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t b = 0; b < 3; ++b) {
            const auto got = scene.frame(i).poses[b], expected = pile.frame(2 + i).poses[b];
            EXPECT_EQ(got.translation, expected.translation.cast<float>().cast<double>());
            EXPECT_LT(got.rotation.angularDistance(expected.rotation), 1e-6);
        }
    EXPECT_EQ(scene.time(3), 0.75);
    EXPECT_FALSE(scene.dynamics);
    EXPECT_EQ(message_of([&] { scene.frame(5); }), file_ + ": there is no frame 5; frames 0:4 are whole");
    EXPECT_EQ(message_of([&] { FrameRange(scene, 3, 5); }),
              "frames 3:5 are impossible; " + file_ + ": there is no frame 5; frames 0:4 are whole");
}

TEST_F(RecordingScene, ItsDigestCoversEveryFrame) {
    record(file_, "pile:bodies=3,frames=9", 0, 5);
    const auto digest = make_scene(file_).digest;
    EXPECT_NE(digest, make_scene("pile:bodies=3,frames=9").digest);
    record(path("same.frames"), "pile:bodies=3,frames=9", 0, 5);
    EXPECT_EQ(make_scene(path("same.frames")).digest, digest);
    // The first and the last frame are those of the first recording; one in between differs.
    const auto scene = make_scene("pile:bodies=3,frames=9");
    auto writer = RecordingWriter::create(path("other.frames"), recording_of(scene.key, scene, 0.25));
    for (const std::size_t i : {0, 1, 3, 3, 4})
        writer.append(i, 0.25 * static_cast<double>(i), scene.frame(i));
    EXPECT_NE(make_scene(path("other.frames")).digest, digest);
}

/// Motion does not depend on a field, so that any recording can be given one. A field of the recorded scene
/// is kept or missed.
TEST_F(RecordingScene, PressureFields) {
    const std::string pile = "pile:bodies=2,refine=1";
    record(file_, pile, 0, 2);
    const auto plain = make_scene(file_);
    EXPECT_TRUE(plain.meshes[0].pressures.empty());
    const auto given = make_scene(file_, {.pressure = 1e7});
    EXPECT_EQ(given.meshes[0].pressures, make_scene(pile, {.pressure = 1e7}).meshes[0].pressures);
    EXPECT_NE(given.digest, plain.digest);
    EXPECT_NE(given.digest, make_scene(file_, {.pressure = 2e7}).digest);
    EXPECT_NE(given.key, plain.key);
    record(path("with.frames"), pile, 0, 2, {.pressure = 1e7});
    EXPECT_FALSE(make_scene(path("with.frames"), {.pressure = 1e7}).meshes[0].pressures.empty());
    for (const auto& reading : {MeshReading{}, MeshReading{.pressure = 2e7}})
        EXPECT_THAT(message_of([&] { make_scene(path("with.frames"), reading); }),
                    HasSubstr("give --duplicates, --weld and --pressure as its simulation had them"));
}

TEST_F(RecordingScene, OfADescription) {
    record(file_, description("[0, 0, 0.1]"), 0, 3);
    const auto scene = make_scene(file_);
    EXPECT_EQ(scene.frame(2).poses[0].translation.z(), 0.1); // fixed: not rounded to float
    EXPECT_THAT(scene.key,
                MatchesRegex("recording:drift,frames=3,digest=[0-9a-f]+,of=two:frames=4,bodies=[0-9a-f]+"));
    description("[0, 0, 0.2]");
    EXPECT_THAT(message_of([&] { make_scene(file_); }),
                MatchesRegex(
                    ".*drift.frames: was recorded from a scene with digest [0-9a-f]+, but .*two.json now has "
                    "[0-9a-f]+; restore that scene, give --duplicates, .* or record again"));
    std::filesystem::remove(path("two.json"));
    EXPECT_THAT(message_of([&] { make_scene(file_); }),
                MatchesRegex(".*drift.frames: its scene cannot be made again: .*two.json: cannot be read.*"));
}

TEST_F(RecordingScene, InvalidSourcesAreRefused) {
    record(file_, "pile:bodies=3,frames=9", 0, 1);
    auto header = Recording(file_).header();
    header.specification = path("itself.frames");
    RecordingWriter::create(path("itself.frames"), header);
    EXPECT_THAT(message_of([&] { make_scene(path("itself.frames")); }), HasSubstr("is a recording itself"));
    header.specification = "pile:bodies=3,frames=9";
    header.bodies[1].kind = RecordedKind::fixed;
    RecordingWriter::create(path("kinds.frames"), header);
    EXPECT_THAT(message_of([&] { make_scene(path("kinds.frames")); }),
                HasSubstr("was recorded from a scene"));
    header = Recording(file_).header();
    RecordingWriter::create(path("none.frames"), header);
    EXPECT_EQ(message_of([&] { make_scene(path("none.frames")); }),
              path("none.frames") + ": there is no frame 0; no frame is whole");
}

TEST_F(RecordingScene, SimulatedScenesAreRefusedWithAHint) {
    auto scene = make_scene("pile:bodies=3,frames=1");
    scene.dynamics = std::make_shared<const Dynamics>();
    EXPECT_EQ(message_of([&] { FrameRange(scene, 0, 4); }),
              "frames 0:4 are impossible; scene pile moves by simulation and has its start only, frame 0: "
              "record it "
              "with 'tandem simulate pile -o FILE.frames' and name FILE.frames");
    EXPECT_EQ(message_of([&] { FrameRange(scene, 4, 2); }),
              "frames 4:2 are impossible; scene pile has frames 0:0");
    EXPECT_EQ(FrameRange(scene, 0, 0).size(), 1u);
}

} // namespace
} // namespace tandem
