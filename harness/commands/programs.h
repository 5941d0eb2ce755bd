// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace tandem {

/// Where a program runs and what becomes of what it prints; a file is appended to, empty is as this process
/// has it.
struct ProgramStreams {
    std::string folder;
    std::string output, errors;
};

/// Runs a program of PATH, outside of any job of MPI, or of a path, and waits until it ends. A signal that
/// asks this process to end while an Interrupt lives is handed to it. Returns its exit code, 127 where there
/// is no such program, or 128 and the signal that ended it.
int run_program(const std::vector<std::string>& words, const ProgramStreams& place = {});

/// A Python 3 that has a module, the system's first, which has the system's packages. Throws InputError:
/// `who`, and the package to install.
std::string python_with(const std::string& module, const std::string& package, const std::string& who);

} // namespace tandem
