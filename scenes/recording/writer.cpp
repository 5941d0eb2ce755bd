// SPDX-License-Identifier: MIT
#include "scenes/recording/writer.h"

#include "base/durable.h"
#include "base/error.h"
#include "base/files_in_use.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Text for a message: how a recording's header differs from the wanted one.
std::string difference(const RecordingHeader& found, const RecordingHeader& wanted) {
    if (found.scene_digest != wanted.scene_digest || found.bodies != wanted.bodies)
        return fmt::format("is of scene {} with digest {:016x}, not of {} with {:016x}", found.specification,
                           found.scene_digest, wanted.specification, wanted.scene_digest);
    if (found.seconds_per_frame != wanted.seconds_per_frame)
        return fmt::format("has a frame every {} s, not every {} s", found.seconds_per_frame,
                           wanted.seconds_per_frame);
    return fmt::format("names its scene {}, not {}", found.specification, wanted.specification);
}

/// True for a part of the header, which a kill leaves. A loss of power can leave zeros after the part.
bool is_partial_header(const recording::RecordingFile& file, const std::string& header) {
    if (file.size() > header.size()) return false;
    auto found = file.read(0, file.size());
    found.resize(found.find_last_not_of('\0') + 1);
    const auto last = header.find_last_not_of('\0') + 1; // end of the complete header
    return found.size() < last && header.starts_with(found);
}

} // namespace

RecordingHeader recording_of(const std::string& specification, const Scene& scene, double seconds_per_frame) {
    if (specification.empty() || specification.ends_with(".frames"))
        throw InputError(fmt::format(
            "scene {} cannot be recorded; name a scene of 'tandem scenes' or a description", scene.name));
    if (!(seconds_per_frame >= 0 && std::isfinite(seconds_per_frame)))
        throw InputError(fmt::format("{} s a frame are impossible; give 0 or more", seconds_per_frame));
    // A description needs its path; the key of any other scene has the present values of its defaults.
    const bool described = specification.ends_with(".json");
    return {described ? specification : scene.key, scene.digest, seconds_per_frame, recorded_bodies(scene)};
}

RecordingWriter::RecordingWriter(recording::RecordingFile file, const RecordingHeader& header)
    : file_(std::move(file)),
      header_(header),
      header_bytes_(recording::encode(header).size()),
      frame_bytes_(recording::frame_bytes(header)) {}

RecordingWriter RecordingWriter::create(const std::string& path, const RecordingHeader& header) {
    check_name(checkpoint_path(path) + ".partial");
    RecordingWriter writer(recording::RecordingFile(path, recording::RecordingFile::Mode::create), header);
    // The checkpoint of an earlier recording at this path must not be resumed with the new one.
    recording::remove_if_exists(checkpoint_path(path));
    sync_folder_of(path);
    writer.file_.write(0, recording::encode(header));
    return writer;
}

RecordingWriter RecordingWriter::resume(const std::string& path, const RecordingHeader& header) {
    RecordingWriter writer(recording::RecordingFile(path, recording::RecordingFile::Mode::update), header);
    // After a kill during the write of the header, the checkpoint can be that of an earlier recording.
    if (const auto bytes = recording::encode(header); is_partial_header(writer.file_, bytes)) {
        recording::remove_if_exists(checkpoint_path(path));
        writer.file_.write(0, bytes);
    }
    const auto found = recording::read_header(writer.file_).first;
    if (found != header)
        throw InputError(fmt::format("{}: {}; resume it as it was begun or choose another file", path,
                                     difference(found, header)));
    const auto rest = writer.file_.size() - writer.header_bytes_;
    auto& whole = writer.frames_;
    whole = rest / writer.frame_bytes_;
    // After a crash of the machine the file can have its final length without all bytes.
    while (
        whole > 0
        && !recording::matches(writer.file_.read(writer.offset(whole - 1), writer.frame_bytes_), whole - 1))
        --whole;
    return writer;
}

std::optional<Checkpoint> RecordingWriter::restore() {
    auto checkpoint = read_checkpoint(path(), header_.scene_digest);
    if (!checkpoint && frames_ > 0)
        throw InputError(
            fmt::format("{}: does not exist, so {} with its {} frames cannot be resumed; restore "
                        "it or record to another file",
                        checkpoint_path(path()), path(), frames_));
    if (!checkpoint) return std::nullopt;
    if (checkpoint->frames > frames_)
        throw InputError(
            fmt::format("{}: has {} frames, its checkpoint {}; restore the recording or record to "
                        "another file",
                        path(), frames_, checkpoint->frames));
    check_frames(checkpoint->frames);
    cut_to(checkpoint->frames);
    return checkpoint;
}

void RecordingWriter::check_frames(std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i)
        if (!recording::matches(file_.read(offset(i), frame_bytes_), i))
            throw InputError(fmt::format("{}: frame {} does not match its checksum; restore the recording or "
                                         "record to another file",
                                         path(), i));
}

void RecordingWriter::append(std::uint64_t step, double time, const Frame& frame) {
    const auto bytes = recording::encode(header_, frames_, step, time, frame, path());
    cut_to(frames_); // removes a partial frame that a crash or a full disk left
    file_.write(offset(frames_), bytes);
    ++frames_;
}

void RecordingWriter::checkpoint(std::uint64_t steps_done, std::span<const std::byte> state) {
    file_.sync();
    write_checkpoint(path(), header_.scene_digest, steps_done, frames_, state);
}

std::uint64_t RecordingWriter::offset(std::size_t number) const {
    return header_bytes_ + number * frame_bytes_;
}

void RecordingWriter::cut_to(std::size_t frames) {
    file_.truncate(offset(frames));
    frames_ = frames;
}

} // namespace tandem
