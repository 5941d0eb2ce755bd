// SPDX-License-Identifier: MIT
#pragma once

namespace tandem {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP only asks to end, so that what is being measured is
/// written first; a second one ends the program at once, of SIGTERM one that comes a second later. One at a
/// time.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Whether a signal has come.
    static bool asked();
};

} // namespace tandem
