// SPDX-License-Identifier: MIT
#pragma once

#include <exception>
#include <string_view>

namespace tandem {

/// Ends replays between two frames, because the user asked for the end. No error: commands catch it.
struct Interrupted : std::exception {
    const char* what() const noexcept override { return "interrupted"; }
};

/// Handles SIGINT, SIGTERM and SIGHUP during its lifetime. The first signal only requests the end, so that
/// results are written first. A second signal ends the program at once; a second SIGTERM must come at least a
/// second later. At most one object may exist at a time.
class Interrupt {
public:
    /// What the first signal prints on standard error, at once.
    static constexpr std::string_view stopping =
        "tandem: stopping after this frame; what is measured is written; Ctrl-C again ends at once\n";

    /// `message` must outlive this object; when it is empty, the first signal prints nothing.
    explicit Interrupt(std::string_view message = {});
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    /// Whether a signal has arrived.
    static bool asked();
    /// The exit code after a signal, as of a program that it ended: 128 plus its number.
    static int exit_code();
};

} // namespace tandem
