// SPDX-License-Identifier: MIT
#include "harness/accuracy/figures.h"

#include "scenes/error.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace tandem {

std::string_view figures_script(); // made by CMakeLists.txt

namespace {

/// Whether the program ended with 0; one that is not there ends otherwise.
bool succeeds(std::vector<std::string> words, bool quiet) {
    std::vector<char*> arguments(words.size() + 1); // the last one stays null
    for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (quiet)
        for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
            posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    int status = ::posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (status != 0) return false;
    while (::waitpid(process, &status, 0) < 0)
        if (errno != EINTR) return false;
    return status == 0;
}

/// The system's, which has the system's packages, or the first one in PATH.
std::string python_with_matplotlib() {
    for (const char* python : {"/usr/bin/python3", "python3"})
        if (succeeds({python, "-c", "import matplotlib"}, true)) return python;
    throw InputError("--figures needs python3 with matplotlib; install python3-matplotlib");
}

} // namespace

Figures::Figures(std::string folder) : folder_(std::move(folder)), python_(python_with_matplotlib()) {
    std::error_code code;
    std::filesystem::create_directories(folder_, code);
    if (code) throw InputError(fmt::format("--figures: cannot make {}: {}", folder_, code.message()));
}

void Figures::draw(const std::string& records) const {
    // What has been printed comes before what the script prints.
    std::fflush(stdout);
    if (!succeeds({python_, "-c", std::string(figures_script()), records, folder_}, false))
        throw InputError(fmt::format("--figures: nothing drawn; the records are in {}", records));
}

} // namespace tandem
