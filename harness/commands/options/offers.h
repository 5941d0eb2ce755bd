// SPDX-License-Identifier: MIT
// What a shell offers: words from the tables that listings print.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace tandem {

/// What stands before the word that is being typed.
struct LineBefore {
    const CLI::App* command = nullptr;
    std::span<const std::string> words;
};

/// Words that may come next, in place of what is typed behind the last of `separators`.
struct Offer {
    std::vector<std::string> words;
    std::string_view separators{};
    std::size_t kept = 0; ///< so many letters at the beginning have no separators
};

/// Of an option's value, of which `text` is typed: what its name says, or the A|B|C of its help.
Offer offer_values(const LineBefore& before, const CLI::Option& option, const std::string& text);

/// Of an argument that belongs to no option: scenes, algorithms or shells, as the command has it.
Offer offer_arguments(const LineBefore& before, const std::string& text);

} // namespace tandem
