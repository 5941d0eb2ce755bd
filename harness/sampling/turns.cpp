// SPDX-License-Identifier: MIT
#include "harness/sampling/turns.h"

#include "base/error.h"
#include "harness/sampling/processor_condition.h"

#include <cerrno>
#include <cinttypes>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

namespace tandem {

namespace {

constexpr int pause_ms = 50; ///< between two calls of `stop`

/// Programs that this process starts do not inherit the descriptor. Returns whether it is open.
bool keep(int descriptor) { return fcntl(descriptor, F_SETFD, FD_CLOEXEC) == 0; }

} // namespace

bool Turns::are_taken() { return std::getenv(variable) != nullptr; }

std::optional<Turns> Turns::from_environment() {
    const char* text = std::getenv(variable);
    if (text == nullptr) return std::nullopt;
    int from = -1, to = -1, length = 0;
    std::uint64_t seed = 0;
    const bool is_read = std::sscanf(text, "%d,%d,%" SCNu64 "%n", &from, &to, &seed, &length) == 3;
    if (!is_read || text[length] != '\0' || !keep(from) || !keep(to))
        throw InputError(
            fmt::format("{} is '{}'; only 'tandem compare --run' sets it: unset it", variable, text));
    return Turns(from, to, seed);
}

void Turns::wait(const std::function<bool()>& stop) const {
    ProcessorReader::leave_out([&] { wait_for_turn(stop); });
}

void Turns::wait_for_turn(const std::function<bool()>& stop) const {
    constexpr char ready = 'r';
    // A closed pipe is an error here, not the end of the program.
    const auto before = std::signal(SIGPIPE, SIG_IGN);
    const bool is_open = write(to_, &ready, 1) == 1;
    std::signal(SIGPIPE, before);
    while (is_open && !stop()) {
        pollfd waiting{from_, POLLIN, 0};
        if (poll(&waiting, 1, pause_ms) <= 0) continue;
        char go = 0;
        if (read(from_, &go, 1) >= 0 || errno != EINTR) return;
    }
}

} // namespace tandem
