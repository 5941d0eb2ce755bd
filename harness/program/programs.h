// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace tandem {

/// The working folder of a program and the files that its output is appended to. An empty text means: as this
/// process.
struct ProgramStreams {
    std::string folder;
    std::string output, errors;
};

/// Runs a program, found in PATH or by its path, outside of any MPI job, and waits until it ends. While an
/// Interrupt exists, a signal that asks this process to end is forwarded. Returns its exit code, 127 when
/// there is no such program, or 128 plus the number of the signal that ended it.
int run_program(const std::vector<std::string>& words, const ProgramStreams& streams = {});

/// A Python 3 that can import `module`; the system's Python is tried first. Throws InputError that names
/// `user`, the option or command that needs it, and the package to install.
std::string python_with(const std::string& module, const std::string& package, const std::string& user);

} // namespace tandem
