// SPDX-License-Identifier: MIT
#include "scenes/recording/bytes.h"
#include "tests/support/folder.h"
#include "tests/support/recordings.h"
#include "tests/support/test.h"

#include <thread>

namespace tandem {
namespace {

using namespace support;
using testing::HasSubstr;

class RecordingFrames : public FolderTest {
protected:
    SmallRecording small_;
    std::string file_ = path("small.frames");
};

double through_float(double x) { return static_cast<double>(static_cast<float>(x)); }

void expect_bits(const Eigen::Vector3d& read, const Eigen::Vector3d& written) {
    for (int i = 0; i < 3; ++i) EXPECT_EQ(read[i], through_float(written[i]));
}

void expect_frame(const RecordedFrame& read, const Frame& written, const Scene& scene) {
    for (std::size_t b = 2; b < scene.bodies.size(); ++b) {
        expect_bits(read.frame.poses[b].translation, written.poses[b].translation);
        const auto& q = written.poses[b].rotation;
        const auto expected =
            unit({through_float(q.w()), through_float(q.x()), through_float(q.y()), through_float(q.z())});
        EXPECT_EQ(read.frame.poses[b].rotation.coeffs(), expected.coeffs());
    }
    EXPECT_EQ(read.frame.poses[0].translation, written.poses[0].translation); // fixed: not rounded to float
    EXPECT_EQ(read.frame.poses[1].translation, Eigen::Vector3d::Zero());
    ASSERT_EQ(read.frame.deformed.size(), 4u);
    ASSERT_EQ(read.frame.deformed[1].size(), 4u);
    EXPECT_TRUE(read.frame.deformed[0].empty());
    for (std::size_t v = 0; v < 4; ++v) expect_bits(read.frame.deformed[1][v], written.deformed[1][v]);
}

TEST_F(RecordingFrames, EveryNumberRoundTrips) {
    small_.write(file_, 5);
    const Recording recording(file_);
    EXPECT_EQ(recording.header(), small_.header);
    ASSERT_EQ(recording.frames(), 5u);
    for (const std::size_t i : {4, 0, 2}) {
        const auto read = recording.read(i, small_.scene.frame(0).poses);
        EXPECT_EQ(read.step, 10 * i);
        EXPECT_EQ(read.time, 0.01 * static_cast<double>(i));
        EXPECT_EQ(recording.time(i), read.time);
        expect_frame(read, small_.frame(i), small_.scene);
    }
    // Two rigid bodies, four vertices; step, time and checksum.
    EXPECT_EQ(std::filesystem::file_size(file_),
              recording::encode(small_.header).size() + 5 * (56 + 48 + 20));
}

TEST_F(RecordingFrames, BytesAreAsDocumented) {
    small_.write(file_, 2);
    const auto bytes = bytes_of(file_);
    const std::string start("\x89TDMFR\r\n\x01\0\0\0\x59\0\0\0", 16);
    EXPECT_EQ(bytes.substr(0, 16), start);
    EXPECT_EQ(bytes.substr(32, 8), std::string("\x04\0\0\0\x0d\0\0\0", 8));
    EXPECT_EQ(bytes.substr(40, 13), "pile:bodies=4");
    EXPECT_EQ(bytes.substr(53, 16), std::string("\x01\0\0\0\0\0\0\0\x02\0\0\0\x04\0\0\0", 16));
    EXPECT_EQ(bytes.substr(89 + 124, 8), std::string("\x0a\0\0\0\0\0\0\0", 8));
    EXPECT_EQ(recording::checksum("123456789"), 0xcbf43926u); // the check value of CRC-32
}

TEST_F(RecordingFrames, ThreadsReadConcurrently) {
    small_.write(file_, 40);
    const Recording recording(file_);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = 0; i < 400; ++i) {
                const auto number = (i * 7 + t * 11) % 40;
                EXPECT_EQ(recording.read(number, small_.scene.frame(0).poses).step, 10 * number);
            }
        });
    for (auto& thread : threads) thread.join();
}

TEST_F(RecordingFrames, InvalidFramesAreRefused) {
    auto writer = RecordingWriter::create(file_, small_.header);
    const auto fails = [&](auto change) {
        auto frame = small_.frame(0);
        change(frame);
        return message_of([&] { writer.append(0, 0, frame); });
    };
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_THAT(fails([](Frame& f) { f.poses[2].translation.x() = 1e39; }),
                HasSubstr("small.frames: body 2 of frame 0 is beyond single precision"));
    EXPECT_THAT(fails([](Frame& f) { f.poses[3].rotation.w() += 0.1; }),
                HasSubstr("not turned by a rotation"));
    EXPECT_THAT(fails([&](Frame& f) { f.deformed[1][3].z() = -infinite; }), HasSubstr("body 1 of frame 0"));
    EXPECT_THAT(fails([](Frame& f) { f.deformed[1].pop_back(); }), HasSubstr("has 3 vertices, not 4"));
    EXPECT_THAT(fails([](Frame& f) { f.poses.pop_back(); }), HasSubstr("has 3 bodies, the recording 4"));
    EXPECT_THAT(message_of([&] { writer.append(0, std::nan(""), small_.frame(0)); }),
                HasSubstr("time of frame 0"));
    EXPECT_EQ(writer.frames(), 0u);
    EXPECT_EQ(Recording(file_).frames(), 0u);
    EXPECT_THAT(message_of([&] { recording_of("x.frames", small_.scene, 0.1); }),
                HasSubstr("cannot be recorded"));
    EXPECT_THAT(message_of([&] { recording_of("pile", small_.scene, -1); }), HasSubstr("impossible"));
}

} // namespace
} // namespace tandem
