// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/header.h"

#include <string_view>

namespace tandem {

/// A recorded frame, rounded to single precision.
struct RecordedFrame {
    std::uint64_t step = 0;
    double time = 0; ///< s
    Frame frame;
};

namespace recording {

/// The bytes of frame `number`. Throws InputError that begins with `path` when a body does not match the
/// header or is not finite in single precision.
std::string encode(const RecordingHeader& header, std::uint64_t number, std::uint64_t step, double time,
                   const Frame& frame, const std::string& path);

/// True when `bytes` end with the checksum of frame `number`.
bool matches(std::string_view bytes, std::uint64_t number);

/// Decodes a frame from bytes that match their checksum. Fixed bodies get their poses from `fixed`;
/// quaternions are normalised in double. Throws InputError that begins with `location` when a body is not
/// finite or its quaternion is not a rotation.
RecordedFrame decode(const RecordingHeader& header, std::string_view bytes, const std::vector<Pose>& fixed,
                     const std::string& location);

} // namespace recording

} // namespace tandem
