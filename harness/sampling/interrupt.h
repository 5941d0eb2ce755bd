// SPDX-License-Identifier: MIT
#pragma once

namespace tandem {

/// Handles SIGINT, SIGTERM and SIGHUP during its lifetime. The first signal only requests the end, so that
/// results are written first. A second signal ends the program at once; a second SIGTERM must come at least a
/// second later. At most one object may exist at a time.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Whether a signal has arrived.
    static bool asked();
};

} // namespace tandem
