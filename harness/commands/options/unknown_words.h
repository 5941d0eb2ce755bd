// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
}

namespace tandem {

/// Once the words of a line could not be read: which command or option of it there is not, with the nearest
/// that there is; empty when that is not what is wrong with it.
std::string unknown_word(const CLI::App& app, std::span<const std::string> line);

} // namespace tandem
