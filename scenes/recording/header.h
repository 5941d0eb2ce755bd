// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/file.h"
#include "scenes/scene.h"

namespace tandem {

/// How a body stands in the frames of a recording, with the values of the file.
enum class RecordedKind : std::uint32_t { rigid = 0, fixed = 1, deformable = 2 };

struct RecordedBody {
    RecordedKind kind = RecordedKind::rigid;
    std::uint32_t vertices = 0; ///< of a deformable body, otherwise 0

    bool operator==(const RecordedBody&) const = default;
};

/// What a recording is of. Throughout, frames are numbered from 0.
struct RecordingHeader {
    std::string specification; ///< make_scene() of it makes the scene again
    std::uint64_t scene_digest = 0;
    double seconds_per_frame = 0; ///< between frames, as planned; each frame has its own time as well
    std::vector<RecordedBody> bodies;

    bool operator==(const RecordingHeader&) const = default;
};

/// The bodies of a scene as a recording has them.
std::vector<RecordedBody> recorded_bodies(const Scene& scene);

namespace recording {

inline constexpr std::uint32_t version = 1;

/// Bytes of one frame: step, time, seven floats a rigid body, three a deformable vertex, checksum.
std::uint64_t frame_bytes(const RecordingHeader& header);

/// The bytes a recording begins with (README.md has their layout).
std::string encode(const RecordingHeader& header);

/// The header of an open recording and how many bytes it takes; throws InputError.
std::pair<RecordingHeader, std::uint64_t> read_header(const File& file);

} // namespace recording

} // namespace tandem
