// SPDX-License-Identifier: MIT
// Completion of lines by a shell: its script asks the program, which answers from its own tables.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace tandem {

enum class Shell { bash, zsh };

/// The text of scripts/completion.
std::string_view completion_script(Shell shell);

/// Whether a script is asking: "completion --words WORD...".
bool asks_for_completion(std::span<const std::string> line);

/// Prints what the last WORD of such a line may become, one a line: nothing where that is a file or the
/// user's to think of. Devices are looked for where one is wanted only. Returns 0.
int complete(const CLI::App& app, std::span<const std::string> line);

} // namespace tandem
