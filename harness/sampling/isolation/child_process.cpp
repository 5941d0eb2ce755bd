// SPDX-License-Identifier: MIT
#include "harness/sampling/isolation/child_process.h"

#include "harness/program/launcher.h"
#include "base/error.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tandem {

/// Owns a file descriptor and closes it.
class ChildProcess::Descriptor {
public:
    explicit Descriptor(int number = -1) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor() { close(); }

    int number() const { return number_; }
    bool is_open() const { return number_ >= 0; }
    void close() {
        if (is_open()) ::close(std::exchange(number_, -1));
    }

private:
    int number_;
};

namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const char* what, int error) {
    throw OutputError(fmt::format("cannot start a child process: {}: {}", what, std::strerror(error)));
}

using Descriptor = ChildProcess::Descriptor;

struct Pipe {
    Pipe() {
        std::array<int, 2> ends{};
        if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe", errno);
        read = Descriptor(ends[0]);
        write = Descriptor(ends[1]);
    }
    Descriptor read, write;
};

/// Starts the program with the descriptors as its standard input and output.
pid_t start(std::span<const std::string> arguments, const Descriptor& input, const Descriptor& output) {
    static const std::string program = "/proc/self/exe";
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, input.number(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output.number(), STDOUT_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    pid_t child = 0;
    const auto environment = environment_without_launcher();
    const int error =
        posix_spawn(&child, program.c_str(), &actions, &attributes, words.data(), environment.data());
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) fail("posix_spawn", error);
    return child;
}

enum class End { of_answer, of_output, of_time, of_user };

/// A limit in seconds from the construction; 0: no limit.
class Deadline {
public:
    explicit Deadline(double seconds) : seconds_(seconds), begin_(Clock::now()) {}

    /// Milliseconds for poll(); -1: no limit.
    int left_ms() const {
        if (seconds_ <= 0) return -1;
        const std::chrono::duration<double> left =
            begin_ + std::chrono::duration<double>(seconds_) - Clock::now();
        return std::max(0, static_cast<int>(std::min(left.count() * 1e3 + 1, 1e9)));
    }
    bool has_expired() const { return left_ms() == 0; }

private:
    double seconds_;
    Clock::time_point begin_;
};

/// Writes as much of the input as the pipe accepts; closes the pipe when it has no reader.
void write_some(Descriptor& pipe, std::string_view& input) {
    const auto written = ::write(pipe.number(), input.data(), input.size());
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) return;
    if (written > 0) input.remove_prefix(static_cast<std::size_t>(written));
    if (written < 0) pipe.close();
}

/// Appends available data to the output; false at its end.
bool read_some(const Descriptor& pipe, std::string& output) {
    std::array<char, 65536> part{};
    const auto count = ::read(pipe.number(), part.data(), part.size());
    if (count < 0) return errno == EINTR;
    output.append(part.data(), static_cast<std::size_t>(count));
    return count > 0;
}

/// When to give up on an answer: after `seconds` (0: never), or once `stop` returns true.
struct Patience {
    double seconds;
    const std::function<bool()>& stop;
};

/// Milliseconds for poll() until the deadline or the next call of `stop`.
int next_look_ms(const Deadline& deadline) {
    constexpr int between_looks_ms = 50;
    const int left = deadline.left_ms();
    return left < 0 ? between_looks_ms : std::min(left, between_looks_ms);
}

/// Sends the input and reads the output until the child answers, closes its output, or the patience ends.
End exchange(Descriptor& to, const Descriptor& from, std::string_view input, std::string& output,
             const Patience& patience) {
    const Deadline deadline(patience.seconds);
    for (;;) {
        if (patience.stop()) return End::of_user;
        // poll() ignores negative descriptors.
        const int writable = input.empty() ? -1 : to.number();
        std::array<pollfd, 2> ends{{{from.number(), POLLIN, 0}, {writable, POLLOUT, 0}}};
        const int ready = poll(ends.data(), ends.size(), next_look_ms(deadline));
        if (deadline.has_expired()) return End::of_time;
        if (ready < 0 && errno != EINTR) fail("poll", errno);
        if (ready <= 0) continue;
        if (ends[1].revents != 0) write_some(to, input);
        if (ends[0].revents == 0) continue;
        if (!read_some(from, output)) return End::of_output;
        // Libraries can print text after the answer.
        if (const auto answer = output.find(end_of_answer); answer != std::string::npos) {
            output.resize(answer);
            return End::of_answer;
        }
    }
}

/// Whether the child closes its output in time; discards further output.
bool closes_output(const Descriptor& output, double seconds) {
    const Deadline deadline(seconds);
    std::array<char, 4096> rest{};
    while (!deadline.has_expired()) {
        pollfd end{output.number(), POLLIN, 0};
        if (poll(&end, 1, deadline.left_ms()) <= 0) continue;
        if (::read(output.number(), rest.data(), rest.size()) == 0) return true;
    }
    return false;
}

std::string failure_text(int status) {
    if (WIFSIGNALED(status))
        return fmt::format("ended by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    return WEXITSTATUS(status) == 0 ? "" : fmt::format("ended with code {}", WEXITSTATUS(status));
}

int wait_for(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    return status;
}

} // namespace

struct ChildProcess::Running {
    pid_t child = 0;
    Descriptor to, from;
};

ChildProcess::ChildProcess(std::span<const std::string> arguments) : running_(std::make_unique<Running>()) {
    Pipe in, out;
    running_->child = start(arguments, in.read, out.write);
    running_->to = std::move(in.write);
    running_->from = std::move(out.read);
    fcntl(running_->to.number(), F_SETFL, O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
    if (!running_) return;
    constexpr double grace_seconds = 10; // closing a driver lasts some seconds
    running_->to.close();                // the child ends at the end of its input
    if (!closes_output(running_->from, grace_seconds)) kill(running_->child, SIGKILL);
    wait_for(running_->child);
}

bool ChildProcess::has_ended() const { return !running_; }

ChildResult ChildProcess::ask(const std::string& line, double seconds, const std::function<bool()>& stop) {
    ChildResult result;
    const auto end = exchange(running_->to, running_->from, line + '\n', result.output, {seconds, stop});
    if (end == End::of_answer) return result;
    const auto running = std::exchange(running_, nullptr);
    if (end != End::of_output) kill(running->child, SIGKILL);
    result.stopped = end == End::of_user;
    const int status = wait_for(running->child);
    result.failure = end == End::of_time ? fmt::format("took longer than {:g} s and was ended", seconds)
                                         : failure_text(status);
    return result;
}

void end_with_parent() {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() == 1) std::_Exit(3); // the parent has already ended
}

} // namespace tandem
