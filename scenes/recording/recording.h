// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/frame.h"

namespace tandem {

/// An open file of recorded frames. Frames are read on demand. Thread-safe.
class Recording {
public:
    /// Reads and checks the header; throws InputError.
    explicit Recording(const std::string& path);

    const std::string& path() const { return file_.path(); }
    const RecordingHeader& header() const { return header_; }
    /// Number of complete frames when the file was opened; a truncated last frame does not count.
    std::size_t frames() const { return frames_; }
    /// Message of read() for frames from frames() on.
    std::string end() const;

    /// Frame `number`. Fixed bodies get their poses from `fixed`, which has one pose a body. Throws
    /// InputError when the frame does not exist, is truncated, or does not match its checksum.
    RecordedFrame read(std::size_t number, const std::vector<Pose>& fixed) const;
    /// The step of the simulation that a frame is of, its time in s, and its stored checksum; throw
    /// InputError when the frame does not exist.
    std::uint64_t step(std::size_t number) const;
    double time(std::size_t number) const;
    std::uint32_t stored_checksum(std::size_t number) const;
    /// True when the frame's bytes match its checksum.
    bool intact(std::size_t number) const;
    /// Position of frame `number` in the file.
    std::uint64_t offset(std::size_t number) const { return header_bytes_ + number * frame_bytes_; }

private:
    void check(std::size_t number) const;

    recording::RecordingFile file_;
    RecordingHeader header_;
    std::uint64_t header_bytes_ = 0;
    std::uint64_t frame_bytes_ = 0;
    std::size_t frames_ = 0;
    bool cut_off_ = false;
};

/// The scene of a recording. make_scene() of its specification gives meshes and bodies; frames are read from
/// the recording on demand. The name is the file's without folder and suffix; the digest covers the scene's
/// digest and every frame's checksum. Throws InputError, also when the scene differs from the recorded one.
Scene load_recording(const std::string& path, const MeshReading& reading = {});

} // namespace tandem
