// SPDX-License-Identifier: MIT
#include "harness/paper/drawing.h"

#include "harness/paper/python_package.h"
#include "harness/programs.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tandem {

namespace fs = std::filesystem;

PaperDrawing::PaperDrawing()
    : python_(python_with("matplotlib, pandas, scipy", "python3-matplotlib python3-pandas python3-scipy",
                          "tandem paper")) {
    for (const auto& file : python_package()) {
        const auto path = fs::path(package_.path()) / file.path;
        fs::create_directories(path.parent_path());
        std::ofstream out(path);
        if (!(out << file.text).flush())
            throw InputError(
                fmt::format("{}: cannot be written; make room there or set TMPDIR", path.string()));
    }
}

bool PaperDrawing::draw(const std::string& folder) const {
    const auto* const script =
        "import sys; sys.path.insert(0, sys.argv.pop(1)); sys.dont_write_bytecode = True; "
        "import tandem.paper.command as command; sys.exit(command.main(sys.argv[1:]))";
    return run_program({python_, "-c", script, package_.path(), folder},
                       {"", flush_output() ? "" : "/dev/null", ""})
           == 0;
}

} // namespace tandem
