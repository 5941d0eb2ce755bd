// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/checkpoint.h"
#include "scenes/recording/frame.h"

namespace tandem {

/// The header of a new recording of `scene`, the result of make_scene(specification). Throws InputError when
/// the scene cannot be recreated from a specification.
RecordingHeader recording_of(const std::string& specification, const Scene& scene, double seconds_per_frame);

/// Writes frames of a simulation, which can be killed at any moment and resumed:
///
///     auto writer = resume ? RecordingWriter::resume(path, header) : RecordingWriter::create(path, header);
///     if (const auto checkpoint = writer.restore()) simulation.restore(checkpoint->state);
///     else writer.checkpoint(0, simulation.state());
///     while (simulation.steps_done() < steps) {
///         const auto report = simulation.step(detect);
///         writer.append(report.step, report.midway_time(), simulation.midway());
///         if (interval_passed) writer.checkpoint(simulation.steps_done(), simulation.state());
///     }
///
/// Only one process can write a recording at a time. All functions throw InputError, or OutputError when
/// writing fails.
class RecordingWriter {
public:
    /// Starts a recording. Throws InputError when the file exists.
    static RecordingWriter create(const std::string& path, const RecordingHeader& header);
    /// Opens a recording with an equal header. Bytes after its last complete frame are ignored, and the next
    /// frame overwrites them.
    static RecordingWriter resume(const std::string& path, const RecordingHeader& header);

    /// The checkpoint to resume from; frames recorded after it are dropped. None when there are neither
    /// frames nor a checkpoint. Throws InputError when frames have no matching checkpoint.
    std::optional<Checkpoint> restore();
    /// Adds a frame with its time in s. The frame survives the end of the process, but not a crash of the
    /// machine.
    void append(std::uint64_t step, double time, const Frame& frame);
    /// Makes all frames, then the state of the simulation after `steps_done` steps, survive a crash of the
    /// machine.
    void checkpoint(std::uint64_t steps_done, std::span<const std::byte> state);

    std::size_t frames() const { return frames_; }
    const std::string& path() const { return file_.path(); }

private:
    RecordingWriter(recording::RecordingFile file, const RecordingHeader& header);
    std::uint64_t offset(std::size_t number) const;
    void cut_to(std::size_t frames);
    /// Throws InputError when one of the first `count` frames is damaged, since nothing checks them later.
    void check_frames(std::size_t count) const;

    recording::RecordingFile file_;
    RecordingHeader header_;
    std::uint64_t header_bytes_ = 0;
    std::uint64_t frame_bytes_ = 0;
    std::size_t frames_ = 0;
};

} // namespace tandem
