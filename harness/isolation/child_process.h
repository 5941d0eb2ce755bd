// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

namespace tandem {

/// What became of a process.
struct ChildResult {
    std::string output;  ///< all of its standard output
    std::string failure; ///< "ended by signal 11 (Segmentation fault)"; empty when it ended with code 0
};

/// Runs this program again with these arguments, in a process group of its own, so that signals of a terminal
/// do not reach it, and waits until it ends; after `seconds`, where they are above 0, it is killed. It reads
/// `input` from its standard input and shares standard error. Throws OutputError when no process can be made.
ChildResult run_child(std::span<const std::string> arguments, const std::string& input, double seconds);

/// Called by the child: it ends when its parent does.
void end_with_parent();

} // namespace tandem
