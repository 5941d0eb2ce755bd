// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
}

namespace tandem {

/// The message for a line that could not be parsed: it names the unknown command or option and the nearest
/// known one. Empty when the line has another mistake.
std::string unknown_word(const CLI::App& app, std::span<const std::string> line);

} // namespace tandem
