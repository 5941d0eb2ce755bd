// SPDX-License-Identifier: MIT
#include "scenes/recording/recording.h"

#include "base/error.h"
#include "base/files_in_use.h"
#include "scenes/read/cursor.h"

#include <cmath>
#include <fmt/format.h>

namespace tandem {

/// Frames have equal sizes, so that the file's size gives their number. A remainder is a truncated frame.
Recording::Recording(const std::string& path) : file_(path, recording::RecordingFile::Mode::read) {
    note_input(path);
    std::tie(header_, header_bytes_) = recording::read_header(file_);
    frame_bytes_ = recording::frame_bytes(header_);
    const auto rest = file_.size() - header_bytes_;
    frames_ = rest / frame_bytes_;
    cut_off_ = rest % frame_bytes_ != 0;
}

std::string Recording::end() const {
    const auto whole =
        frames_ == 0 ? std::string("no frame is whole") : fmt::format("frames 0:{} are whole", frames_ - 1);
    return cut_off_ ? fmt::format("{}: frame {} is cut off; {}", path(), frames_, whole)
                    : fmt::format("{}: there is no frame {}; {}", path(), frames_, whole);
}

void Recording::check(std::size_t number) const {
    if (number > frames_)
        throw InputError(
            fmt::format("{}: there is no frame {}; {}", path(), number, end().substr(path().size() + 2)));
    if (number == frames_) throw InputError(end());
}

RecordedFrame Recording::read(std::size_t number, const std::vector<Pose>& fixed) const {
    check(number);
    const auto bytes = file_.read(offset(number), frame_bytes_);
    if (!recording::matches(bytes, number))
        throw InputError(
            fmt::format("{}: frame {} does not match its checksum; copy or record it again", path(), number));
    return recording::decode(header_, bytes, fixed, fmt::format("{}: frame {}", path(), number));
}

/// Reads only the step, with which the frame begins.
std::uint64_t Recording::step(std::size_t number) const {
    check(number);
    const auto bytes = file_.read(offset(number), 8);
    return read::Cursor(bytes, path()).get<std::uint64_t>("step");
}

/// Reads only the time, which is at byte 8 of the frame.
double Recording::time(std::size_t number) const {
    check(number);
    const auto bytes = file_.read(offset(number) + 8, 8);
    return std::bit_cast<double>(read::Cursor(bytes, path()).get<std::uint64_t>("time"));
}

std::uint32_t Recording::stored_checksum(std::size_t number) const {
    check(number);
    const auto bytes = file_.read(offset(number + 1) - sizeof(std::uint32_t), sizeof(std::uint32_t));
    return read::Cursor(bytes, path()).get<std::uint32_t>("checksum");
}

bool Recording::intact(std::size_t number) const {
    check(number);
    return recording::matches(file_.read(offset(number), frame_bytes_), number);
}

} // namespace tandem
