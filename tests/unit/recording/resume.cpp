// SPDX-License-Identifier: MIT
#include "tests/support/folder.h"
#include "tests/support/recordings.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<std::byte> state_of(std::size_t steps) {
    std::vector<std::byte> state(1000 + steps);
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = static_cast<std::byte>(i * 7 + steps);
    return state;
}

/// Six frames with a checkpoint after the fourth, from a killed run; and the same without a kill.
class RecordingResume : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        small_.write(path("whole.frames"), 6);
        auto writer = RecordingWriter::create(file_, small_.header);
        writer.checkpoint(0, state_of(0));
        small_.append(writer, 0, 4);
        writer.checkpoint(40, state_of(40));
        small_.append(writer, 4, 6);
    }
    std::string resume_failure() const {
        return message_of([&] { RecordingWriter::resume(file_, small_.header).restore(); });
    }

    SmallRecording small_;
    std::string file_ = path("small.frames");
};

TEST_F(RecordingResume, ContinuesFromTheCheckpointWithTheSameBytes) {
    const auto whole = bytes_of(path("whole.frames"));
    EXPECT_EQ(bytes_of(file_), whole);
    const auto fourth = Recording(file_).offset(4);
    for (auto size = fourth; size <= whole.size(); ++size) {
        SCOPED_TRACE(size);
        write_bytes(file_, whole.substr(0, size));
        auto writer = RecordingWriter::resume(file_, small_.header);
        const auto checkpoint = writer.restore();
        ASSERT_TRUE(checkpoint);
        EXPECT_EQ(checkpoint->step, 40u);
        EXPECT_EQ(checkpoint->state, state_of(40));
        EXPECT_EQ(writer.frames(), 4u);
        EXPECT_EQ(bytes_of(file_), whole.substr(0, fourth));
        small_.append(writer, 4, 6);
        EXPECT_EQ(bytes_of(file_), whole);
    }
    write_bytes(file_, whole.substr(0, fourth - 1));
    EXPECT_EQ(resume_failure(), file_
                                    + ": has 3 frames, its checkpoint 4; restore the recording or record to "
                                      "another file");
    EXPECT_EQ(bytes_of(file_), whole.substr(0, fourth - 1)) << "an error must not lose frames";
}

TEST_F(RecordingResume, ADamagedFrameBeforeTheCheckpointIsDetected) {
    const auto whole = bytes_of(file_);
    for (const std::size_t frame : {0, 2, 3}) {
        auto damaged = whole;
        damaged[Recording(file_).offset(frame) + 20] ^= 1;
        write_bytes(file_, damaged);
        EXPECT_EQ(resume_failure(),
                  fmt::format("{}: frame {} does not match its checksum; restore the recording or record to "
                              "another file",
                              file_, frame));
        EXPECT_EQ(bytes_of(file_), damaged);
        write_bytes(file_, whole);
    }
}

TEST_F(RecordingResume, TheNextFrameReplacesAnIncompleteTail) {
    const auto whole = bytes_of(path("whole.frames"));
    const auto second = Recording(file_).offset(2);
    for (const std::size_t rest : {0, 1, 123}) {
        write_bytes(file_, whole.substr(0, second + rest));
        auto writer = RecordingWriter::resume(file_, small_.header);
        EXPECT_EQ(writer.frames(), 2u);
        small_.append(writer, 2, 3);
        EXPECT_EQ(bytes_of(file_), whole.substr(0, Recording(path("whole.frames")).offset(3)));
    }
    // A crash of the machine: the length was written, the bytes were not.
    auto holes = whole.substr(0, second);
    holes.resize(Recording(path("whole.frames")).offset(4));
    write_bytes(file_, holes);
    auto writer = RecordingWriter::resume(file_, small_.header);
    EXPECT_EQ(writer.frames(), 2u);
    small_.append(writer, 2, 3);
    EXPECT_EQ(bytes_of(file_), whole.substr(0, Recording(path("whole.frames")).offset(3)));
}

TEST_F(RecordingResume, AKillInTheHeaderRestarts) {
    const auto whole = bytes_of(path("whole.frames"));
    const auto header = whole.substr(0, Recording(file_).offset(0));
    for (std::size_t size = 0; size < header.size(); ++size) {
        write_bytes(file_, whole.substr(0, size));
        write_bytes(checkpoint_path(file_), "of an older recording");
        {
            auto writer = RecordingWriter::resume(file_, small_.header);
            EXPECT_FALSE(writer.restore());
            EXPECT_EQ(writer.frames(), 0u);
            EXPECT_EQ(bytes_of(file_), header);
        }
        // A loss of power: the length was written, the bytes were not.
        write_bytes(file_, whole.substr(0, size) + std::string(header.size() - size, '\0'));
        EXPECT_EQ(RecordingWriter::resume(file_, small_.header).frames(), 0u);
        EXPECT_EQ(bytes_of(file_), header);
    }
}

TEST_F(RecordingResume, NothingIsOverwritten) {
    const auto before = bytes_of(file_);
    EXPECT_EQ(message_of([&] { RecordingWriter::create(file_, small_.header); }),
              file_ + ": exists and is not overwritten; resume it or choose another file");
    EXPECT_EQ(bytes_of(file_), before);
    EXPECT_TRUE(std::filesystem::exists(checkpoint_path(file_)));
    auto writer = RecordingWriter::resume(file_, small_.header);
    EXPECT_THAT(resume_failure(), HasSubstr("another process writes it"));
    std::filesystem::remove(checkpoint_path(file_));
    EXPECT_THAT(message_of([&] { writer.restore(); }), HasSubstr("small.frames.checkpoint: does not exist"));
    EXPECT_EQ(bytes_of(file_), before);
    EXPECT_THAT(message_of([&] { RecordingWriter::resume(path("none.frames"), small_.header); }),
                HasSubstr("none.frames: cannot be written"));
}

TEST_F(RecordingResume, OnlyAStartedRecordingResumes) {
    const auto failure = [&](auto change) {
        auto header = small_.header;
        change(header);
        return message_of([&] { RecordingWriter::resume(file_, header); });
    };
    EXPECT_THAT(failure([](auto& h) { ++h.scene_digest; }),
                HasSubstr("small.frames: is of scene pile:bodies=4"));
    EXPECT_THAT(failure([](auto& h) { h.bodies[2].kind = RecordedKind::fixed; }), HasSubstr("is of scene"));
    EXPECT_THAT(failure([](auto& h) { h.seconds_per_frame = 0.5; }),
                HasSubstr("a frame every 0.01 s, not every 0.5"));
    EXPECT_THAT(failure([](auto& h) { h.specification = "other.json"; }),
                HasSubstr("names its scene pile:bodies=4"));
    EXPECT_EQ(failure([](auto&) {}), "no error");
}

TEST_F(RecordingResume, AKillDuringACheckpointKeepsTheOldOne) {
    const auto old = bytes_of(checkpoint_path(file_));
    for (std::size_t size = 0; size < old.size(); size += 100) {
        write_bytes(checkpoint_path(file_) + ".partial", old.substr(0, size));
        auto writer = RecordingWriter::resume(file_, small_.header);
        EXPECT_EQ(writer.restore()->state, state_of(40));
        writer.checkpoint(50, state_of(50));
        EXPECT_EQ(writer.restore()->step, 50u);
        EXPECT_FALSE(std::filesystem::exists(checkpoint_path(file_) + ".partial"));
        writer.checkpoint(40, state_of(40));
    }
    EXPECT_EQ(bytes_of(checkpoint_path(file_)), old);
}

TEST_F(RecordingResume, DamagedCheckpointsAreRefused) {
    const auto whole = bytes_of(checkpoint_path(file_));
    for (std::size_t size = 0; size < whole.size(); ++size) {
        write_bytes(checkpoint_path(file_), whole.substr(0, size));
        EXPECT_THAT(resume_failure(), StartsWith(checkpoint_path(file_) + ": ")) << size;
    }
    for (std::size_t at = 0; at < whole.size(); ++at) {
        auto bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
        write_bytes(checkpoint_path(file_), bytes);
        EXPECT_THAT(resume_failure(), StartsWith(checkpoint_path(file_) + ": ")) << at;
    }
    auto bytes = whole;
    bytes[8] = 9;
    write_bytes(checkpoint_path(file_), bytes);
    EXPECT_THAT(resume_failure(), HasSubstr("has version 9 of the format, this program reads version 1"));
    write_checkpoint(file_, small_.scene.digest + 1, 40, 4, state_of(40));
    EXPECT_THAT(resume_failure(), HasSubstr("resume with the scene it was begun with"));
    std::filesystem::remove(checkpoint_path(file_));
    std::filesystem::create_directory(checkpoint_path(file_));
    EXPECT_THAT(resume_failure(), HasSubstr("is not a regular file"));
}

} // namespace
} // namespace tandem
