// SPDX-License-Identifier: MIT
// Shell completion: the script of the shell calls the program, which answers from its own tables.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace tandem {

enum class Shell { bash, zsh };

/// The script of scripts/completion for this shell.
std::string_view completion_script(Shell shell);

/// Whether a completion script calls the program: "completion --words WORD...".
bool asks_for_completion(std::span<const std::string> line);

/// Prints the completions of the last WORD of such a line, one for each line. Prints nothing for files and
/// free text. Devices are searched only when the word is a device. Returns 0.
int complete(const CLI::App& app, std::span<const std::string> line);

} // namespace tandem
