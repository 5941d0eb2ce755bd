// SPDX-License-Identifier: MIT
#include "harness/commands/options/completion.h"

#include "harness/commands/options/actions.h"
#include "harness/commands/options/help.h"
#include "harness/commands/options/offers.h"
#include "base/standard_streams.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <set>

namespace tandem {

namespace {

/// Prints the offered words that begin like the last entry of the text and are not in the text yet. Each word
/// follows `prefix` and the unchanged beginning of the text.
void print(const Offer& offer, const std::string& prefix, const std::string& text) {
    const auto last = text.find_last_of(offer.separators);
    const auto begin = std::max(last == std::string::npos ? 0 : last + 1, offer.kept);
    auto earlier = text.substr(0, begin);
    for (auto& letter : earlier)
        if (offer.separators.find(letter) != std::string_view::npos) letter = ',';
    const auto entries = CLI::detail::split(earlier, ',');
    std::set<std::string> used(entries.begin(), entries.end());
    for (const auto& word : offer.words)
        if (word.starts_with(text.substr(begin)) && used.insert(word).second)
            put("{}{}{}\n", prefix, text.substr(0, begin), word);
}

std::vector<std::string> long_options(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* option : app.get_options())
        for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

/// Prints the completions of a word before any command.
void print_commands(const CLI::App& app, const std::string& text) {
    std::vector<std::string> names;
    for (const auto* each : listed_commands(app)) names.push_back(each->get_name());
    print({text.starts_with('-') ? long_options(app) : names}, "", text);
}

/// The option whose value is being typed, and where in the word the value begins; null when there is none.
std::pair<const CLI::Option*, std::size_t> option_before(const LineBefore& before, const std::string& word) {
    const auto equals = word.starts_with("--") ? word.find('=') : std::string::npos;
    const bool joined = equals != std::string::npos;
    const auto& name = joined ? word.substr(0, equals) : before.words.back();
    const auto* option = name.starts_with('-') ? before.command->get_option_no_throw(name) : nullptr;
    if (option == nullptr || option->get_items_expected_max() == 0) return {nullptr, 0};
    return {option, joined ? equals + 1 : 0};
}

/// Prints the completions of a word after a command.
void print_next(const LineBefore& before, const std::string& word) {
    if (const auto [option, begin] = option_before(before, word); option != nullptr) {
        const auto text = word.substr(begin);
        print(offer_values(before, *option, text), word.substr(0, begin), text);
    } else if (word.starts_with('-')) {
        print({long_options(*before.command)}, "", word);
    } else {
        print(offer_arguments(before, word), "", word);
    }
}

} // namespace

bool asks_for_completion(std::span<const std::string> line) {
    return line.size() >= 2 && line[0] == "completion" && line[1] == "--words";
}

int complete(const CLI::App& app, std::span<const std::string> line) {
    const auto words = line.subspan(2);
    const auto word = words.empty() ? std::string() : words.back();
    const auto rest = words.first(words.empty() ? 0 : words.size() - 1);
    const auto name = std::ranges::find_if(rest, [](const auto& w) { return !w.starts_with('-'); });
    if (name == rest.end()) print_commands(app, word);
    for (const auto* command : listed_commands(app))
        if (name != rest.end() && command->get_name() == *name) print_next({command, rest}, word);
    return 0;
}

Action add_completion(CLI::App& app) {
    auto shell = std::make_shared<std::string>();
    app.add_option("shell", *shell,
                   "bash or zsh: print the script that completes tandem's commands (cmake --install "
                   "installs it)")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh"}))
        ->option_text("SHELL");
    app.footer("source <(tandem completion bash)");
    return [shell] {
        put_text(completion_script(*shell == "bash" ? Shell::bash : Shell::zsh));
        return 0;
    };
}

} // namespace tandem
