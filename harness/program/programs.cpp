// SPDX-License-Identifier: MIT
#include "harness/program/programs.h"

#include "harness/program/interrupt.h"
#include "harness/program/launcher.h"
#include "base/error.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace tandem {

namespace {

/// The file actions of posix_spawn, which run between fork and exec.
class Actions {
public:
    explicit Actions(const ProgramStreams& streams) {
        posix_spawn_file_actions_init(&actions_);
        open(STDOUT_FILENO, streams.output);
        open(STDERR_FILENO, streams.errors);
        if (!streams.folder.empty()) posix_spawn_file_actions_addchdir_np(&actions_, streams.folder.c_str());
    }
    ~Actions() { posix_spawn_file_actions_destroy(&actions_); }
    Actions(const Actions&) = delete;
    Actions& operator=(const Actions&) = delete;

    const posix_spawn_file_actions_t* get() const { return &actions_; }

private:
    void open(int stream, const std::string& path) {
        if (!path.empty())
            posix_spawn_file_actions_addopen(&actions_, stream, path.c_str(), O_WRONLY | O_CREAT | O_APPEND,
                                             0666);
    }
    posix_spawn_file_actions_t actions_{};
};

int code_of(int status) { return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status); }

} // namespace

int run_program(const std::vector<std::string>& words, const ProgramStreams& streams) {
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const Actions actions(streams);
    pid_t process = 0;
    const auto environment = environment_without_launcher();
    if (posix_spawnp(&process, arguments[0], actions.get(), nullptr, arguments.data(), environment.data())
        != 0)
        return 127;
    // Signals do not interrupt system calls here (see Interrupt), so the loop polls.
    bool signalled = false;
    for (int status = 0;;) {
        const auto ended = waitpid(process, &status, WNOHANG);
        if (ended == process) return code_of(status);
        if (ended < 0 && errno != EINTR) return 127;
        if (Interrupt::asked() && !std::exchange(signalled, true)) kill(process, SIGTERM);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

std::string python_with(const std::string& module, const std::string& package, const std::string& user) {
    for (const char* python : {"/usr/bin/python3", "python3"})
        if (run_program({python, "-c", "import " + module}, {"", "/dev/null", "/dev/null"}) == 0)
            return python;
    throw InputError(fmt::format("{} needs python3 with {}; install {}", user, module, package));
}

} // namespace tandem
