// SPDX-License-Identifier: MIT
#include "harness/commands/options/external_options.h"

#include "harness/commands/external.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace tandem {

CLI::Option* add_external_option(CLI::App& app, const std::string& name, const std::string& description) {
    return app.add_option(name, CLI::callback_t{}, description);
}

CLI::Option* add_external_flag(CLI::App& app, const std::string& name, const std::string& description) {
    return app.add_flag(name, description);
}

std::vector<std::string> given_words(const CLI::App& app) {
    std::vector<std::string> words;
    std::vector<std::string> arguments;
    for (const auto* option : app.get_options([](const CLI::Option* each) { return each->count() > 0; })) {
        const auto& values = option->results();
        if (option->get_positional()) {
            arguments.insert(arguments.end(), values.begin(), values.end());
            continue;
        }
        const auto name = "--" + option->get_lnames().front();
        const bool is_flag = option->get_items_expected_max() == 0;
        if (is_flag) words.push_back(name);
        for (const auto& value : values)
            if (!is_flag) words.push_back(fmt::format("{}={}", name, value));
    }
    if (!arguments.empty()) words.emplace_back("--"); // arguments may begin with a dash
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
}

Action run_external_action(const CLI::App& app) {
    return [&app] { return run_external(app.get_name(), given_words(app)); };
}

} // namespace tandem
