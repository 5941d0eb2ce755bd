// SPDX-License-Identifier: MIT
#include "scenes/digest.h"
#include "scenes/error.h"
#include "scenes/recording/bytes.h"
#include "scenes/recording/recording.h"

#include <filesystem>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The scene that was recorded; what goes wrong in making it again is said of the recording.
Scene remade(const Recording& recording) {
    const auto& header = recording.header();
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("{}: {}", recording.path(), what));
    };
    if (header.specification.ends_with(".frames")) fail("its scene is a recording itself; record it again");
    Scene scene;
    try {
        scene = make_scene(header.specification);
    } catch (const InputError& error) {
        fail(fmt::format("its scene cannot be made again: {}", error.what()));
    }
    if (scene.digest != header.scene_digest || recorded_bodies(scene) != header.bodies)
        fail(fmt::format("was recorded of a scene with digest {:016x}, but {} has {:016x} now; restore that "
                         "scene or record again",
                         header.scene_digest, header.specification, scene.digest));
    return scene;
}

/// Frames between the first and the last count as well: nothing but the file says what they hold.
std::uint64_t digest_of(const Recording& recording) {
    std::string text;
    recording::put(text, recording.header().scene_digest);
    recording::put_double(text, recording.header().seconds_per_frame);
    for (std::size_t i = 0; i < recording.frames(); ++i) recording::put(text, recording.stored_checksum(i));
    return tandem::digest_of(std::string_view(text));
}

} // namespace

Scene load_recording(const std::string& path) {
    const auto recording = std::make_shared<const Recording>(path);
    auto scene = remade(*recording);
    if (recording->frames() == 0) throw InputError(recording->end());
    scene.name = std::filesystem::path(path).stem().string();
    scene.digest = digest_of(*recording);
    // Of the scene's own key: the text in the header can be a path, which is no one's business.
    scene.key = fmt::format("recording:{},frames={},digest={:016x},of={}", scene.name, recording->frames(),
                            scene.digest, scene.key);
    scene.frame_count = recording->frames();
    scene.dynamics = nullptr;
    scene.end = recording->end();
    scene.time = [recording](std::size_t i) { return recording->time(i); };
    scene.frame = [recording, fixed = scene.frame(0).poses](std::size_t i) {
        return recording->read(i, fixed).frame;
    };
    return scene;
}

} // namespace tandem
