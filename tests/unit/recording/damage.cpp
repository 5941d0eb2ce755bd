// SPDX-License-Identifier: MIT
#include "scenes/recording/bytes.h"
#include "tests/support/folder.h"
#include "tests/support/recordings.h"
#include "tests/support/test.h"

namespace tandem {
namespace {

using namespace support;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t frame_size = 124, frame_count = 3;

/// A complete recording of three frames, and the errors of reading modified copies.
class RecordingDamage : public FolderTest {
protected:
    void SetUp() override {
        FolderTest::SetUp();
        small_.write(path("whole.frames"), frame_count);
        whole_ = bytes_of(path("whole.frames"));
        header_size_ = whole_.size() - frame_count * frame_size;
    }
    std::string failure(std::string_view bytes) const {
        write_bytes(file_, bytes);
        return message_of([&] { readable_frames(Recording(file_), small_.scene); });
    }

    SmallRecording small_;
    std::string file_ = path("small.frames");
    std::string whole_;
    std::size_t header_size_ = 0;
};

TEST_F(RecordingDamage, ATruncatedFileIsReadUpToTheLastWholeFrame) {
    for (std::size_t size = 0; size < whole_.size(); ++size) {
        SCOPED_TRACE(size);
        const auto message = failure(whole_.substr(0, size));
        if (size < header_size_) {
            EXPECT_EQ(message, file_ + ": is cut off in its header; record it again");
            continue;
        }
        EXPECT_EQ(message, "no error");
        const Recording recording(file_);
        const auto frames = (size - header_size_) / frame_size;
        EXPECT_EQ(recording.frames(), frames);
        const auto beyond = message_of([&] { recording.read(frames, {}); });
        EXPECT_THAT(beyond, StartsWith(file_ + ": "));
        EXPECT_THAT(beyond,
                    HasSubstr((size - header_size_) % frame_size == 0 ? "there is no frame" : "is cut off"));
    }
}

TEST_F(RecordingDamage, ErrorsNameIncompleteAndMissingFrames) {
    write_bytes(file_, whole_.substr(0, whole_.size() - 1));
    const Recording recording(file_);
    EXPECT_EQ(message_of([&] { recording.read(2, {}); }),
              file_ + ": frame 2 is cut off; frames 0:1 are whole");
    EXPECT_EQ(message_of([&] { recording.read(7, {}); }),
              file_ + ": there is no frame 7; frame 2 is cut off; frames 0:1 are whole");
    EXPECT_EQ(message_of([&] { Recording(path("whole.frames")).read(3, {}); }),
              path("whole.frames") + ": there is no frame 3; frames 0:2 are whole");
    write_bytes(file_, whole_.substr(0, header_size_ + 1));
    EXPECT_EQ(Recording(file_).end(), file_ + ": frame 0 is cut off; no frame is whole");
}

TEST_F(RecordingDamage, EveryChangedBitIsDetected) {
    for (std::size_t at = 0; at < whole_.size(); ++at)
        for (int bit = 0; bit < 8; ++bit) {
            SCOPED_TRACE(at);
            auto bytes = whole_;
            bytes[at] = static_cast<char>(bytes[at] ^ (1 << bit));
            const auto message = failure(bytes);
            if (at >= header_size_)
                EXPECT_EQ(message, file_ + ": frame " + std::to_string((at - header_size_) / frame_size)
                                       + " does not match its checksum; copy or record it again");
            else
                EXPECT_THAT(message,
                            AnyOf(HasSubstr("is not a recording"), HasSubstr("of the format"),
                                  HasSubstr("cut off in its header"), HasSubstr("checksum in the header")));
        }
}

TEST_F(RecordingDamage, SwappedFramesAreDetected) {
    auto bytes = whole_;
    const auto second = bytes.substr(header_size_ + frame_size, frame_size);
    bytes.replace(header_size_, frame_size, second);
    EXPECT_THAT(failure(bytes), HasSubstr("frame 0 does not match"));
}

TEST_F(RecordingDamage, OtherFilesAndVersions) {
    EXPECT_THAT(failure("frame,body_a,tet_a,body_b,tet_b\n"), HasSubstr("is not a recording of frames"));
    EXPECT_THAT(failure(""), HasSubstr("is cut off in its header"));
    auto bytes = whole_;
    bytes[8] = 7;
    EXPECT_EQ(failure(bytes),
              file_ + ": has version 7 of the format, this program reads version 1; record it again");
    EXPECT_THAT(message_of([&] { Recording(path("none.frames")); }),
                HasSubstr("none.frames: cannot be read"));
    EXPECT_THAT(message_of([&] { Recording(path("")); }), HasSubstr("is not a regular file"));
}

/// Replaces bytes of the header and recomputes its checksum, as an attacker would.
std::string with_header(std::string bytes, std::size_t header_size, std::size_t at, std::string_view change) {
    bytes.replace(at, change.size(), change);
    return recording::sealed(bytes.substr(0, header_size - 4)) + bytes.substr(header_size);
}

TEST_F(RecordingDamage, InvalidValuesWithAValidChecksumAreRefused) {
    const auto changed = [&](std::size_t at, std::string_view change) {
        return failure(with_header(whole_, header_size_, at, change));
    };
    EXPECT_EQ(changed(40, "pile:bodies=4"), "no error");
    EXPECT_THAT(changed(24, std::string_view("\0\0\0\0\0\0\xf8\x7f", 8)), HasSubstr("not a valid time"));
    EXPECT_THAT(changed(32, "\xff\xff\xff\xff"), HasSubstr("do not fill the header"));
    EXPECT_THAT(changed(36, "\xff\xff\xff\xff"), HasSubstr("do not fill the header"));
    EXPECT_THAT(changed(53, "\x03"), HasSubstr("3 is not a kind of body"));
    EXPECT_THAT(changed(65, "\xff\xff\xff\xff"), AnyOf(EndsWith("no error"), HasSubstr("cut off")));
    auto frame = small_.frame(0);
    auto bytes = recording::encode(small_.header, 0, 0, 0, frame, "");
    for (std::size_t at = 16; at < frame_size - 4; at += 4) {
        auto wrong = bytes;
        wrong.replace(at, 4, std::string_view("\0\0\xc0\x7f", 4)); // not a number
        EXPECT_THAT(
            message_of([&] { recording::decode(small_.header, wrong, small_.scene.frame(0).poses, "here"); }),
            HasSubstr("here has a body that is not finite"));
    }
}

TEST_F(RecordingDamage, AThousandRandomChangesNeverCrash) {
    Random random(11);
    std::size_t refused = 0;
    for (int round = 0; round < 1000; ++round) {
        auto bytes = whole_;
        for (auto changes = 1 + random.next() % 8; changes > 0; --changes)
            bytes[random.next() % bytes.size()] = static_cast<char>(random.next());
        if (random.next() % 2 == 0) bytes.resize(random.next() % bytes.size());
        // Half of the copies get a valid header, so that the checks behind its checksum run.
        if (random.next() % 2 == 0 && bytes.size() > header_size_)
            bytes = with_header(bytes, header_size_, 0, whole_.substr(0, 16));
        if (failure(bytes) != "no error") {
            ++refused;
            continue;
        }
        if (Recording(file_).header().bodies != small_.header.bodies) continue; // frames of another size
        const auto kept = (bytes.size() - header_size_) / frame_size * frame_size;
        EXPECT_TRUE(bytes.substr(header_size_, kept) == whole_.substr(header_size_, kept));
    }
    EXPECT_GT(refused, 500u);
    EXPECT_LT(refused, 1000u);
}

} // namespace
} // namespace tandem
