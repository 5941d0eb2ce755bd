// SPDX-License-Identifier: MIT
#include "tests/support/folder.h"
#include "tests/support/recordings.h"

#include <csignal>
#include <sys/wait.h>

namespace tandem {
namespace {

using namespace support;

constexpr std::size_t most_frames = 20000;

std::vector<std::byte> state_of(std::size_t frames) {
    std::vector<std::byte> state(20000);
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = static_cast<std::byte>(i * 31 + frames);
    return state;
}

RecordingWriter open_writer(const std::string& file, const RecordingHeader& header) {
    return std::filesystem::exists(file) ? RecordingWriter::resume(file, header)
                                         : RecordingWriter::create(file, header);
}

/// Writes frames and checkpoints as a simulation does, with frames known in advance.
void record(const std::string& file, const SmallRecording& small) {
    auto writer = open_writer(file, small.header);
    if (!writer.restore()) writer.checkpoint(0, state_of(0));
    while (writer.frames() < most_frames) {
        small.append(writer, writer.frames(), writer.frames() + 3);
        writer.checkpoint(writer.frames(), state_of(writer.frames()));
    }
}

class RecordingKill : public FolderTest {};

TEST_F(RecordingKill, AtAnyMomentLeavesAResumableFile) {
    const SmallRecording small;
    const auto file = path("killed.frames");
    Random random(17);
    std::size_t frames = 0;
    for (int round = 0; round < 25; ++round) {
        const auto child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            record(file, small);
            _exit(0);
        }
        usleep(static_cast<useconds_t>(random.next() % 15000));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_TRUE(WIFSIGNALED(status));
        if (!std::filesystem::exists(file)) continue;
        auto writer = open_writer(file, small.header);
        const auto checkpoint = writer.restore();
        ASSERT_GE(writer.frames(), frames) << "frames of the last checkpoint are lost";
        frames = writer.frames();
        if (!checkpoint) continue;
        EXPECT_EQ(checkpoint->step, frames);
        EXPECT_EQ(checkpoint->state, state_of(frames));
    }
    EXPECT_GT(frames, 10u);
    auto whole = RecordingWriter::create(path("whole.frames"), small.header);
    small.append(whole, 0, frames);
    EXPECT_TRUE(bytes_of(file) == bytes_of(path("whole.frames")));
}

} // namespace
} // namespace tandem
