// SPDX-License-Identifier: MIT
#include "base/digest.h"
#include "scenes/digest.h"
#include "base/error.h"
#include "scenes/recording/bytes.h"
#include "scenes/recording/recording.h"

#include <charconv>
#include <filesystem>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The value of "NAME=" in a scene specification; empty when it has no such parameter.
std::string_view parameter_in(std::string_view specification, std::string_view name) {
    for (auto at = specification.find(name); at != std::string_view::npos;
         at = specification.find(name, at + 1))
        if (at > 0 && (specification[at - 1] == ':' || specification[at - 1] == ',')
            && specification.substr(at + name.size()).starts_with('=')) {
            const auto value = specification.substr(at + name.size() + 1);
            return value.substr(0, value.find(','));
        }
    return {};
}

/// The file that make_scene() opens for this specification; empty when it opens none.
std::string_view file_of(std::string_view specification) {
    if (specification.ends_with(".json")) return specification;
    const auto mesh = parameter_in(specification, "mesh");
    return mesh.find_first_of("./") == std::string_view::npos ? std::string_view() : mesh;
}

bool is_within(const std::filesystem::path& path, const std::filesystem::path& folder) {
    using std::filesystem::absolute, std::filesystem::weakly_canonical;
    const auto relative =
        weakly_canonical(absolute(path)).lexically_relative(weakly_canonical(absolute(folder)));
    return !relative.empty() && *relative.begin() != "..";
}

/// Recordings are untrusted files. A specification may open only files in the recording's folder or the
/// working directory, and its scene may not have more bodies than the recording.
void check_specification(const RecordingHeader& header, const std::filesystem::path& recording) {
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("{}: {}", recording.string(), what));
    };
    if (header.specification.ends_with(".frames")) fail("its scene is a recording itself; record it again");
    if (const std::filesystem::path file(file_of(header.specification)); !file.empty()) {
        const auto own = recording.parent_path();
        if (!is_within(file, own.empty() ? "." : own) && !is_within(file, std::filesystem::current_path()))
            fail(fmt::format(
                "its scene needs the file {}, but a recording opens only files in its own folder or the "
                "working directory; change to that folder or copy the file",
                file.string()));
    }
    for (const auto* name : {"bodies", "count"}) {
        const auto text = parameter_in(header.specification, name);
        std::uint64_t bodies = 0;
        const auto result = std::from_chars(text.data(), text.data() + text.size(), bodies);
        if (result.ec == std::errc{} && bodies > header.bodies.size())
            fail(fmt::format("has {} bodies, but its scene has {} or more; record it again",
                             header.bodies.size(), bodies));
    }
}

/// Whether the scene is the recorded one, or would be without the pressure fields that `reading` adds: a
/// recording of motion can be given fields.
bool is_recorded(const Scene& scene, const RecordingHeader& header, MeshReading reading) {
    if (scene.digest == header.scene_digest) return true;
    if (!reading.pressure) return false;
    reading.pressure.reset();
    return make_scene(header.specification, reading).digest == header.scene_digest;
}

/// Recreates the recorded scene. Errors name the recording.
Scene recreate_scene(const Recording& recording, const MeshReading& reading) {
    const auto& header = recording.header();
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("{}: {}", recording.path(), what));
    };
    check_specification(header, recording.path());
    Scene scene;
    try {
        scene = make_scene(header.specification, reading);
    } catch (const InputError& error) {
        fail(fmt::format("its scene cannot be made again: {}", error.what()));
    }
    if (!is_recorded(scene, header, reading) || recorded_bodies(scene) != header.bodies)
        fail(fmt::format(
            "was recorded from a scene with digest {:016x}, but {} now has {:016x}; restore that "
            "scene, give --duplicates, --weld and --pressure as its simulation had them, or record "
            "again",
            header.scene_digest, header.specification, scene.digest));
    return scene;
}

/// Includes the checksums of all frames, since only the file defines them. `scene` is the digest of the scene
/// that was made again.
std::uint64_t digest_of(const Recording& recording, std::uint64_t scene) {
    std::string text;
    recording::put(text, scene);
    recording::put_double(text, recording.header().seconds_per_frame);
    for (std::size_t i = 0; i < recording.frames(); ++i) recording::put(text, recording.stored_checksum(i));
    return tandem::digest_of(std::string_view(text));
}

} // namespace

Scene load_recording(const std::string& path, const MeshReading& reading) {
    const auto recording = std::make_shared<const Recording>(path);
    auto scene = recreate_scene(*recording, reading);
    if (recording->frames() == 0) throw InputError(recording->end());
    scene.name = std::filesystem::path(path).stem().string();
    scene.digest = digest_of(*recording, scene.digest);
    // Uses the scene's key: the specification in the header can be a private path.
    scene.key = fmt::format("recording:{},frames={},digest={:016x},of={}", scene.name, recording->frames(),
                            scene.digest, scene.key);
    scene.frame_count = recording->frames();
    scene.dynamics = nullptr;
    scene.end = recording->end();
    scene.time = [recording](std::size_t i) { return recording->time(i); };
    scene.step = [recording](std::size_t i) { return recording->step(i); };
    scene.frame = [recording, fixed = scene.frame(0).poses](std::size_t i) {
        return recording->read(i, fixed).frame;
    };
    return scene;
}

} // namespace tandem
