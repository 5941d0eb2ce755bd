// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace tandem {

/// The path of a program in libexec/tandem, in the build folder or in the installed tree of this program.
/// PATH and the current folder are never searched. Throws InputError when it is missing.
std::string external_program(const std::string& name);

/// Runs such a Python program with these words, waits until it ends, and returns its exit code.
/// TANDEM_PROGRAM is set to the path of this program. A signal that asks this process to end is forwarded.
/// Throws InputError when the program or Python 3 is missing.
int run_external(const std::string& name, const std::vector<std::string>& words);

/// Runs it like this, and returns its standard output. Its messages are dropped.
std::string output_of_external(const std::string& name, const std::vector<std::string>& words);

} // namespace tandem
