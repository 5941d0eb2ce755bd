// SPDX-License-Identifier: MIT
#include "harness/interrupt.h"

#include <array>
#include <csignal>

namespace tandem {

namespace {

volatile std::sig_atomic_t signalled = 0;
constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
std::array<struct sigaction, signals.size()> actions_before{};

} // namespace

Interrupt::Interrupt() {
    signalled = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { signalled = 1; };
    // Once: the second signal does what it would have done. Reads and writes go on.
    action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
    for (std::size_t i = 0; i < signals.size(); ++i) {
        sigaction(signals[i], nullptr, &actions_before[i]);
        // What the caller ignores, as nohup does, stays ignored.
        if (actions_before[i].sa_handler != SIG_IGN) sigaction(signals[i], &action, nullptr);
    }
}

Interrupt::~Interrupt() {
    for (std::size_t i = 0; i < signals.size(); ++i) sigaction(signals[i], &actions_before[i], nullptr);
}

bool Interrupt::asked() { return signalled != 0; }

} // namespace tandem
