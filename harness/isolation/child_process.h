// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <span>
#include <string>

namespace tandem {

/// What became of a process.
struct ChildResult {
    std::string output;    ///< all of its standard output
    bool given_up = false; ///< by limits.give_up
    std::string failure;   ///< "ended by signal 11 (Segmentation fault)"; empty when it ended with code 0
};

/// When a process is killed.
struct ChildLimits {
    double seconds = 0; ///< after so many; 0: never
    /// Asked ten times a second: whether nobody waits for it any more; empty: somebody does.
    std::function<bool()> give_up{};
};

/// Runs this program again with these arguments, in a process group of its own, so that signals of a terminal
/// do not reach it, outside of any job of MPI, and waits until it ends, or kills it. It reads `input` from
/// its standard input and shares standard error. Throws OutputError when no process can be made.
ChildResult run_child(std::span<const std::string> arguments, const std::string& input,
                      const ChildLimits& limits);

/// Called by the child: it ends when its parent does.
void end_with_parent();

} // namespace tandem
