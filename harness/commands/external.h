// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace tandem {

/// A program of libexec/tandem, beside this one in the build folder or in the installed tree; never one of
/// PATH or of the current folder. Throws InputError where it is missing.
std::string external_program(const std::string& name);

/// Runs such a program, which is written in Python, with these words and TANDEM_PROGRAM set to the path of
/// this one, and waits until it ends. A signal that asks this process to end is handed to it. Returns its
/// exit code. Throws InputError where it or Python 3 is missing.
int run_external(const std::string& name, const std::vector<std::string>& words);

} // namespace tandem
