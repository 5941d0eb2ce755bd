// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/options/actions.h"

namespace tandem {

/// What the words of a line ask for, nothing of which has been done: a command's action, or to print help,
/// the version or what a word may become. Throws InputError, one line, for every mistake in the line.
Action read_command_line(int argc, const char* const* argv);

} // namespace tandem
