// SPDX-License-Identifier: MIT
#include "harness/program/external.h"

#include "harness/program/interrupt.h"
#include "harness/program/programs.h"
#include "base/standard_streams.h"
#include "base/temporary_directory.h"
#include "base/error.h"

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <fmt/format.h>

namespace tandem {

namespace {

namespace fs = std::filesystem;

constexpr int not_found = 127;

fs::path own_path() { return fs::read_symlink("/proc/self/exe"); }

int run_external_into(const std::string& name, const std::vector<std::string>& words,
                      const ProgramStreams& streams) {
    const auto path = external_program(name);
    setenv("TANDEM_PROGRAM", own_path().c_str(), 1);
    const Interrupt interrupt;
    // The system's Python comes first, because it has the system's packages.
    for (const char* python : {"/usr/bin/python3", "python3"}) {
        std::vector<std::string> line{python, path};
        line.insert(line.end(), words.begin(), words.end());
        const int code = run_program(line, streams);
        // run_program() ends the command by SIGTERM after any signal.
        if (code == 128 + SIGTERM && Interrupt::asked()) return Interrupt::exit_code();
        if (code != not_found) return code;
    }
    throw InputError(fmt::format("tandem {} needs python3; install it", name));
}

std::string file_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

std::string external_program(const std::string& name) {
    const auto folder = own_path().parent_path();
    for (const auto& root : {folder, folder.parent_path()})
        if (const auto path = root / "libexec/tandem" / name; fs::is_regular_file(path)) return path.string();
    throw InputError(fmt::format("tandem {} is not part of this installation: {} does not exist; install it "
                                 "with cmake --install",
                                 name, (folder.parent_path() / "libexec/tandem" / name).string()));
}

int run_external(const std::string& name, const std::vector<std::string>& words) {
    // Flush first, so that earlier output precedes the program's. If that fails, nobody can read its output.
    return run_external_into(name, words, {"", flush_output() ? "" : "/dev/null", ""});
}

std::string output_of_external(const std::string& name, const std::vector<std::string>& words) {
    const TemporaryDirectory folder;
    const auto output = folder.path() + "/output";
    run_external_into(name, words, {"", output, "/dev/null"});
    return file_text(output);
}

} // namespace tandem
