// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/recording/file.h"
#include "scenes/scene.h"

namespace tandem {

/// Kind of a body in a recording, with the values of the file format.
enum class RecordedKind : std::uint32_t { rigid = 0, fixed = 1, deformable = 2 };

struct RecordedBody {
    RecordedKind kind = RecordedKind::rigid;
    std::uint32_t vertices = 0; ///< number of vertices of a deformable body, otherwise 0

    bool operator==(const RecordedBody&) const = default;
};

/// Scene and time step of a recording. Frames are numbered from 0.
struct RecordingHeader {
    std::string specification; ///< argument of make_scene() that recreates the scene
    std::uint64_t scene_digest = 0;
    double seconds_per_frame = 0; ///< planned interval; each frame also has its own time
    std::vector<RecordedBody> bodies;

    bool operator==(const RecordingHeader&) const = default;
};

/// The bodies of a scene in the form of a recording.
std::vector<RecordedBody> recorded_bodies(const Scene& scene);

namespace recording {

inline constexpr std::uint32_t version = 1;

/// Bytes of one frame: step, time, seven floats a rigid body, three floats a deformable vertex, checksum.
std::uint64_t frame_bytes(const RecordingHeader& header);

/// The bytes of a recording's header (README.md has their layout).
std::string encode(const RecordingHeader& header);

/// The header of an open recording and its size in bytes; throws InputError.
std::pair<RecordingHeader, std::uint64_t> read_header(const RecordingFile& file);

} // namespace recording

} // namespace tandem
