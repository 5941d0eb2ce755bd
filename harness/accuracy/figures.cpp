// SPDX-License-Identifier: MIT
#include "harness/accuracy/figures.h"

#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <initializer_list>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace tandem {

std::string_view figures_script(); // made by CMakeLists.txt

namespace {

/// Whether the program ended with 0; one that is not there ends otherwise. What it prints to `silent`
/// descriptors goes nowhere.
bool succeeds(std::vector<std::string> words, std::initializer_list<int> silent) {
    std::vector<char*> arguments(words.size() + 1); // the last one stays null
    for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int stream : silent)
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
        if (succeeds({python, "-c", "import matplotlib"}, {STDOUT_FILENO, STDERR_FILENO})) return python;
    throw InputError("--figures needs python3 with matplotlib; install python3-matplotlib");
}

} // namespace

Figures::Figures(std::string folder) : folder_(std::move(folder)), python_(python_with_matplotlib()) {
    std::error_code code;
    std::filesystem::create_directories(folder_, code);
    if (code) throw InputError(fmt::format("--figures: cannot make {}: {}", folder_, code.message()));
}

void Figures::draw(const std::string& records) const {
    // What has been printed comes before what the script prints. It draws as well where that cannot be read.
    const std::vector<std::string> script{python_, "-c", std::string(figures_script()), records, folder_};
    if (!(flush_output() ? succeeds(script, {}) : succeeds(script, {STDOUT_FILENO})))
        throw InputError(fmt::format("--figures: nothing drawn; the records are in {}", records));
}

} // namespace tandem
