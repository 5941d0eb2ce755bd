// SPDX-License-Identifier: MIT
#include "harness/paper/drawing.h"

#include "harness/paper/python_package.h"
#include "harness/programs.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tandem {

namespace fs = std::filesystem;

PaperDrawing::PaperDrawing()
    : python_(python_with("matplotlib, pandas, scipy", "python3-matplotlib python3-pandas python3-scipy",
                          "tandem paper")) {
    auto folder = (fs::temp_directory_path() / "tandem-XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr)
        throw InputError(fmt::format("{}: cannot be made; set TMPDIR", folder));
    package_ = folder;
    for (const auto& file : python_package()) {
        const auto path = fs::path(package_) / file.path;
        fs::create_directories(path.parent_path());
        std::ofstream(path) << file.text;
    }
}

PaperDrawing::~PaperDrawing() {
    std::error_code none;
    fs::remove_all(package_, none);
}

bool PaperDrawing::draw(const std::string& folder) const {
    const auto script =
        fmt::format("import sys; sys.path.insert(0, '{}'); sys.dont_write_bytecode = True; "
                    "import tandem.paper.command as command; sys.exit(command.main(sys.argv[1:]))",
                    package_);
    return run_program({python_, "-c", script, folder}, {"", flush_output() ? "" : "/dev/null", ""}) == 0;
}

} // namespace tandem
