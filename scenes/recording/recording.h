// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/frame.h"

namespace tandem {

/// A file of recorded frames, open to read; frames are read when asked for, by any number of threads.
class Recording {
public:
    /// Reads and checks the header; throws InputError.
    explicit Recording(const std::string& path);

    const std::string& path() const { return file_.path(); }
    const RecordingHeader& header() const { return header_; }
    /// Whole frames when it was opened; a cut-off one behind them does not count.
    std::size_t frames() const { return frames_; }
    /// What read() says of frames from frames() on.
    std::string end() const;

    /// Frame `number`, fixed bodies standing as in `fixed` (one pose a body, others are not looked at).
    /// Throws InputError when it is not there, cut off, or does not match its checksum.
    RecordedFrame read(std::size_t number, const std::vector<Pose>& fixed) const;
    /// The time of a frame in s, and its checksum as stored; throws InputError when it is not there.
    double time(std::size_t number) const;
    std::uint32_t stored_checksum(std::size_t number) const;
    /// True when the frame's bytes match its checksum.
    bool intact(std::size_t number) const;
    /// Where frame `number` begins in the file.
    std::uint64_t offset(std::size_t number) const { return header_bytes_ + number * frame_bytes_; }

private:
    void check(std::size_t number) const;

    recording::File file_;
    RecordingHeader header_;
    std::uint64_t header_bytes_ = 0;
    std::uint64_t frame_bytes_ = 0;
    std::size_t frames_ = 0;
    bool cut_off_ = false;
};

/// The scene of a recording with the recorded frames as its motion: meshes and bodies as make_scene() makes
/// them of its specification, frames read when asked for. Its name is the file's without folder and suffix;
/// its digest covers the scene's and every frame's checksum. Throws InputError, also when that scene is
/// another than the recorded one now.
Scene load_recording(const std::string& path);

} // namespace tandem
