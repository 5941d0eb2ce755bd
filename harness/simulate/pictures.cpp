// SPDX-License-Identifier: MIT
#include "harness/simulate/pictures.h"

#include "harness/program/external.h"
#include "base/temporary_directory.h"
#include "harness/program/programs.h"
#include "base/standard_streams.h"
#include "base/error.h"
#include "base/files_in_use.h"
#include "scenes/export/glb.h"
#include "scenes/recording/recording.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <vector>

namespace tandem {

namespace fs = std::filesystem;

Pictures::Pictures(std::string out)
    : out_(std::move(out)),
      script_(external_program("render")),
      python_(python_with("numpy, PIL", "python3-numpy python3-pil", "--pictures")) {
    const auto folder = fs::path(out_).parent_path();
    std::error_code code;
    if (!folder.empty()) fs::create_directories(folder, code);
    if (code)
        throw InputError(fmt::format("--pictures: cannot make {}: {}", folder.string(), code.message()));
    for (const int number : {0, 1, 2}) check_output(fmt::format("{}-{}.png", out_, number));
}

void Pictures::draw(const std::string& recording, const MeshReading& reading) const {
    const auto scene = load_recording(recording, reading);
    const TemporaryDirectory folder;
    const auto glb = folder.path() + "/frames.glb";
    const auto last = scene.frame_count - 1;
    std::vector<std::size_t> frames{0, last / 2, last};
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    write_glb(glb, scene, frames);
    const ProgramStreams streams{"", flush_output() ? "" : "/dev/null", ""};
    if (run_program({python_, script_, glb, out_}, streams) != 0)
        throw InputError(
            fmt::format("--pictures: no pictures drawn; export {} with 'tandem export --glb' and "
                        "draw the file with scripts/render",
                        recording));
}

} // namespace tandem
