// SPDX-License-Identifier: MIT
// Completions that a shell offers: words from the tables that listings print.
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

/// The words before the word that is being typed.
struct LineBefore {
    const CLI::App* command = nullptr;
    std::span<const std::string> words;
};

/// Words that may replace the typed text after the last of `separators`.
struct Offer {
    std::vector<std::string> words;
    std::string_view separators{};
    std::size_t kept = 0; ///< number of leading characters in which separators are ignored
};

/// Completions of an option's value, of which `text` is typed. They depend on the option's name, or are the
/// A|B|C of its help.
Offer offer_values(const LineBefore& before, const CLI::Option& option, const std::string& text);

/// Completions of an argument that belongs to no option: scenes, algorithms or shells, by command.
Offer offer_arguments(const LineBefore& before, const std::string& text);

} // namespace tandem
