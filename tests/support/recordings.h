// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/motion.h"
#include "scenes/recording/recording.h"
#include "scenes/recording/writer.h"
#include "tests/support/scenes.h"

namespace tandem::support {

/// A recording of a fixed, a deformable and two rigid bodies, with small frames.
struct SmallRecording {
    SmallRecording() : scene(crowd(3, 4, 2)) {
        Mesh tiny = scene.meshes[2];
        scene.meshes.assign(3, tiny);
        scene.key = "pile:bodies=4";
        header = recording_of("pile:bodies=4", scene, 0.01);
    }

    /// Frame i; any i is valid.
    Frame frame(std::size_t i) const {
        Random random(100 + i);
        Frame result = scene.frame(0);
        for (std::size_t b = 2; b < scene.bodies.size(); ++b)
            result.poses[b] = {random.rotation(), random.direction()};
        result.deformed[1].clear();
        for (int v = 0; v < 4; ++v) result.deformed[1].push_back(random.direction());
        return result;
    }
    /// Appends frames `first` up to `last`: step 10 i and time 0.01 i for frame i.
    void append(RecordingWriter& writer, std::size_t first, std::size_t last) const {
        for (auto i = first; i < last; ++i) writer.append(10 * i, 0.01 * static_cast<double>(i), frame(i));
    }
    void write(const std::string& path, std::size_t frames) const {
        auto writer = RecordingWriter::create(path, header);
        append(writer, 0, frames);
    }

    Scene scene;
    RecordingHeader header;
};

/// Number of frames of a recording; throws if one of them is not readable.
inline std::size_t readable_frames(const Recording& recording, const Scene& scene) {
    const auto fixed = scene.frame(0).poses;
    for (std::size_t i = 0; i < recording.frames(); ++i) recording.read(i, fixed);
    return recording.frames();
}

} // namespace tandem::support
