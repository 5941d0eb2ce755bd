// SPDX-License-Identifier: MIT
#include "harness/program/interrupt.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <unistd.h>

namespace tandem {

namespace {

/// The number of the first signal; 0: none. Threads read what a handler on another thread writes.
std::atomic<int> signalled = 0;
static_assert(std::atomic<int>::is_always_lock_free);
std::string_view acknowledgement;
constexpr std::string_view erase_line = "\r\033[K"; ///< removes a progress line
bool erases_line = false;
constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
constexpr std::size_t sigterm_index = 1; ///< in `signals`
std::array<struct sigaction, signals.size()> actions_before{};
timespec first_sigterm{};

/// Only calls that are safe in a signal handler.
void write_error(std::string_view text) {
    while (!text.empty()) {
        const auto written = write(STDERR_FILENO, text.data(), text.size());
        if (written <= 0) return;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
}

void request_end(int number) {
    if (signalled != 0) return;
    signalled = number;
    const int error = errno;
    if (erases_line && !acknowledgement.empty()) write_error(erase_line);
    write_error(acknowledgement);
    errno = error;
}

/// At a time limit Slurm sends SIGTERM twice within milliseconds; both count as one.
void handle_sigterm(int number) {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (first_sigterm.tv_sec != 0 && now.tv_sec > first_sigterm.tv_sec + 1) {
        sigaction(SIGTERM, &actions_before[sigterm_index], nullptr);
        raise(SIGTERM);
    }
    if (first_sigterm.tv_sec == 0) first_sigterm = now;
    request_end(number);
}

} // namespace

Interrupt::Interrupt(std::string_view message) {
    signalled = 0;
    acknowledgement = message;
    erases_line = isatty(STDERR_FILENO) != 0;
    first_sigterm = {};
    struct sigaction action {};
    for (std::size_t i = 0; i < signals.size(); ++i) {
        // SA_RESETHAND restores the default for the second signal; SA_RESTART continues reads and writes.
        const bool is_term = i == sigterm_index;
        action.sa_handler = is_term ? handle_sigterm : request_end;
        action.sa_flags = SA_RESTART | (is_term ? 0 : static_cast<int>(SA_RESETHAND));
        sigaction(signals[i], nullptr, &actions_before[i]);
        // A signal that the caller ignores, as nohup does, stays ignored.
        if (actions_before[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr);
    }
}

Interrupt::~Interrupt() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &actions_before[i], nullptr);
}

bool Interrupt::asked() { return signalled != 0; }

int Interrupt::exit_code() { return 128 + signalled; }

} // namespace tandem
