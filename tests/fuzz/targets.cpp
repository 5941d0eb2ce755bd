// SPDX-License-Identifier: MIT
// Readers of untrusted bytes as a libFuzzer target; TANDEM_FUZZ names the reader. An InputError is a valid
// result, any other exception or crash is a defect.
#include "harness/commands/options/command_line.h"
#include "harness/record/finished_cells.h"
#include "harness/plans/plan_file.h"
#include "base/error.h"
#include "scenes/read/read.h"
#include "scenes/recording/bytes.h"
#include "scenes/recording/checkpoint.h"
#include "scenes/recording/recording.h"
#include "scenes/simulate/simulation.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <span>
#include <unistd.h>

namespace {

using namespace tandem;

/// Temporary directory of the process. The program runs in it, so that a recording finds files there.
class Folder {
public:
    Folder() : path_(std::filesystem::temp_directory_path() / fmt::format("tandem-fuzz-{}", getpid())) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    /// Writes a file with these bytes and returns its path.
    std::string file(const char* name, std::string_view bytes) const {
        const auto path = path_ / name;
        std::ofstream(path, std::ios::binary | std::ios::trunc)
            .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return path.string();
    }

private:
    std::filesystem::path path_;
};

std::string file_of(const char* name, std::string_view bytes) {
    static const Folder folder;
    return folder.file(name, bytes);
}

/// The first byte selects the file suffix and how the mesh is read; a line "---" separates TetGen's two
/// files.
void read_any_mesh(std::string_view bytes) {
    constexpr std::array suffixes{".msh", ".mesh", ".vtk", ".vtu", ".veg", ".node"};
    if (bytes.empty()) return;
    const auto choice = static_cast<unsigned char>(bytes.front());
    const std::string suffix = suffixes[choice % suffixes.size()];
    const auto flags = choice / suffixes.size();
    MeshReading reading{.corners = (flags & 1) != 0, .only_tetrahedra = (flags & 2) != 0};
    if ((flags & 4) != 0) reading.weld = 0.5;
    if ((flags & 8) != 0) reading.pressure = 1;
    bytes.remove_prefix(1);
    auto mesh = [&] {
        if (suffix != ".node") return parse_mesh(bytes, "fuzz" + suffix, reading);
        const auto at = std::min(bytes.find("---\n"), bytes.size());
        return parse_tetgen(bytes.substr(0, at), "fuzz.node", bytes.substr(std::min(at + 4, bytes.size())),
                            "fuzz.ele", reading);
    }();
    complete_mesh(mesh, "fuzz" + suffix, reading);
}

/// Reads the first and the last frame.
void read_frames(const Scene& scene) {
    scene.frame(0);
    scene.frame(scene.frame_count - 1);
    if (scene.time) scene.time(scene.frame_count - 1);
}

void read_scene(std::string_view bytes) { read_frames(make_scene(file_of("scene.json", bytes))); }

void read_some_plan(std::string_view bytes) {
    const auto path = file_of("plan.json", bytes);
    if (is_plan(path)) read_plan(path);
}

void overwrite(std::string& bytes, std::size_t at, std::uint32_t value) {
    std::string text;
    recording::put(text, value);
    bytes.replace(at, text.size(), text);
}

/// The same bytes with valid checksums, so that the code behind the checks runs. Frame sizes follow from the
/// header.
std::string with_valid_checksums(std::string bytes) {
    constexpr std::size_t size_at = 12, least = 44;
    if (bytes.size() < least) return bytes;
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + size_at, sizeof size);
    if (size < least || size > bytes.size()) return bytes;
    overwrite(bytes, size - 4, recording::checksum(std::string_view(bytes).substr(0, size - 4)));
    const Recording recorded(file_of("header.frames", bytes));
    for (std::size_t i = 0; i < recorded.frames(); ++i) {
        const auto begin = recorded.offset(i), end = recorded.offset(i + 1) - 4;
        std::string number;
        recording::put(number, std::uint64_t{i});
        overwrite(bytes, end,
                  recording::checksum(std::string_view(bytes).substr(begin, end - begin),
                                      recording::checksum(number)));
    }
    return bytes;
}

/// False for a description of a scene that can take seconds to make, which finds nothing: one with a number
/// of three digits, or with meshes refined more than once.
bool is_small(std::string_view description) {
    std::size_t digits = 0;
    for (const char c : description) {
        digits = c >= '0' && c <= '9' ? digits + 1 : 0;
        if (digits > 2) return false;
    }
    constexpr std::string_view refine = "refine=";
    const auto at = description.find(refine);
    return at == std::string_view::npos || description.substr(at + refine.size()).find_first_of("01") == 0;
}

void read_recording(std::string_view bytes) {
    const auto path = file_of("fuzz.frames", with_valid_checksums(std::string(bytes)));
    const Recording recorded(path);
    const std::vector<Pose> poses(recorded.header().bodies.size());
    for (std::size_t i = 0; i < std::min<std::size_t>(recorded.frames(), 100); ++i) recorded.read(i, poses);
    if (is_small(recorded.header().specification)) read_frames(load_recording(path));
}

const Scene& scene_of_checkpoints() {
    static const auto scene = make_scene("block:bodies=2,drop=1");
    return scene;
}

/// Checksum, scene digest and size are made valid, so that the code behind the checks runs.
void read_checkpoint_of_block(std::string_view given) {
    constexpr std::size_t digest_at = 12, size_at = 36, before_state = 44;
    std::string bytes(given);
    if (bytes.size() >= before_state + 4) {
        std::string text;
        recording::put(text, scene_of_checkpoints().digest);
        bytes.replace(digest_at, text.size(), text);
        text.clear();
        recording::put(text, std::uint64_t{bytes.size() - before_state - 4});
        bytes.replace(size_at, text.size(), text);
        overwrite(bytes, bytes.size() - 4,
                  recording::checksum(std::string_view(bytes).substr(0, bytes.size() - 4)));
    }
    auto path = file_of("fuzz.frames.checkpoint", bytes);
    path.resize(path.size() - std::strlen(".checkpoint"));
    const auto checkpoint = read_checkpoint(path, scene_of_checkpoints().digest);
    if (!checkpoint) return;
    Simulation simulation(scene_of_checkpoints());
    simulation.restore(checkpoint->state);
    simulation.step([](const Frame&, std::vector<ContactPoint>& contacts) { contacts.clear(); });
}

/// The reader of records that --resume uses.
void read_records(std::string_view bytes) {
    const auto path = file_of("fuzz.jsonl", bytes);
    const FinishedCells finished(RecordFile(path), path);
}

/// One word per line; only parsing is tested, no command runs.
void read_words(std::string_view bytes) {
    std::vector<std::string> words{"tandem"};
    for (std::size_t at = 0; at <= bytes.size();) {
        const auto end = std::min(bytes.find('\n', at), bytes.size());
        words.emplace_back(bytes.substr(at, end - at).substr(0, bytes.substr(at, end - at).find('\0')));
        at = end + 1;
    }
    std::vector<const char*> pointers;
    for (const auto& word : words) pointers.push_back(word.c_str());
    read_command_line(static_cast<int>(pointers.size()), pointers.data());
}

const std::map<std::string, void (*)(std::string_view)> targets{{"mesh", read_any_mesh},
                                                                {"scene", read_scene},
                                                                {"plan", read_some_plan},
                                                                {"recording", read_recording},
                                                                {"records", read_records},
                                                                {"words", read_words},
                                                                {"checkpoint", read_checkpoint_of_block}};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const auto target = [] {
        const char* name = std::getenv("TANDEM_FUZZ");
        const auto found = targets.find(name == nullptr ? "" : name);
        if (found == targets.end()) {
            std::fputs("TANDEM_FUZZ names no target\n", stderr);
            std::_Exit(2);
        }
        return found->second;
    }();
    try {
        target({reinterpret_cast<const char*>(data), size});
    } catch (const InputError& error) {
        const std::string_view message(error.what());
        if (message.empty()) std::abort(); // an empty message is a defect too
    }
    return 0;
}
