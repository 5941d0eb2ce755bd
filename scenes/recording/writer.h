// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/checkpoint.h"
#include "scenes/recording/frame.h"

namespace tandem {

/// The header of a new recording of `scene`, which make_scene(specification) has made. Throws InputError when
/// the scene cannot be made again from a text.
RecordingHeader recording_of(const std::string& specification, const Scene& scene, double seconds_per_frame);

/// Writes frames of a simulation so that it can be killed at any moment and go on:
///
///     auto writer = resume ? RecordingWriter::resume(path, header) : RecordingWriter::create(path, header);
///     if (const auto checkpoint = writer.restore()) simulation.restore(checkpoint->state);
///     else writer.checkpoint(0, simulation.state());
///     while (simulation.steps_done() < steps) {
///         const auto report = simulation.step(detect);
///         writer.append(report.step, report.midway_time(), simulation.midway());
///         if (now and then) writer.checkpoint(simulation.steps_done(), simulation.state());
///     }
///
/// One process at a time writes a recording. Everything throws InputError, and OutputError when the disk
/// takes no more.
class RecordingWriter {
public:
    /// Starts a recording; an existing file is never overwritten.
    static RecordingWriter create(const std::string& path, const RecordingHeader& header);
    /// Opens a recording with an equal header; what a crash left behind its last whole frame does not count
    /// and goes with the next frame.
    static RecordingWriter resume(const std::string& path, const RecordingHeader& header);

    /// The checkpoint to go on from; frames recorded after it are dropped. None when nothing is recorded yet
    /// and there is none. Throws when frames are there and no checkpoint that goes with them.
    std::optional<Checkpoint> restore();
    /// Adds a frame with the time that it is of, in s; it survives the end of the process (not of the
    /// machine).
    void append(std::uint64_t step, double time, const Frame& frame);
    /// Makes the frames so far and then the state of the simulation after `steps_done` steps survive a crash
    /// of the machine.
    void checkpoint(std::uint64_t steps_done, std::span<const std::byte> state);

    std::size_t frames() const { return frames_; }
    const std::string& path() const { return file_.path(); }

private:
    RecordingWriter(recording::File file, const RecordingHeader& header);
    std::uint64_t offset(std::size_t number) const;
    void cut_to(std::size_t frames);
    /// Throws InputError when one of the first `count` frames is damaged: nothing would ever say so again.
    void check_frames(std::size_t count) const;

    recording::File file_;
    RecordingHeader header_;
    std::uint64_t header_bytes_ = 0;
    std::uint64_t frame_bytes_ = 0;
    std::size_t frames_ = 0;
};

} // namespace tandem
