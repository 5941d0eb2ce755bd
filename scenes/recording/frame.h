// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/header.h"

#include <string_view>

namespace tandem {

/// A frame as recorded: what float keeps of it.
struct RecordedFrame {
    std::uint64_t step = 0;
    double time = 0; ///< s, that the frame is of
    Frame frame;
};

namespace recording {

/// The bytes of frame `number`; throws InputError that begins with `path` when a body does not fit the header
/// or is not finite in single precision.
std::string encode(const RecordingHeader& header, std::uint64_t number, std::uint64_t step, double time,
                   const Frame& frame, const std::string& path);

/// True when `bytes` end with the checksum of frame `number`.
bool matches(std::string_view bytes, std::uint64_t number);

/// The frame whose bytes, checksum included, match. Fixed bodies stand as in `fixed`; quaternions are
/// normalised in double. Throws InputError that begins with `where` when a body is not finite or not turned
/// by a rotation.
RecordedFrame decode(const RecordingHeader& header, std::string_view bytes, const std::vector<Pose>& fixed,
                     const std::string& where);

} // namespace recording

} // namespace tandem
