// SPDX-License-Identifier: MIT
#include "harness/commands/options/sets.h"

#include "harness/plans/ranges.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace tandem {

namespace {

auto parse_set(const std::string& text) {
    const auto equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        throw InputError(fmt::format("--set {}: give NAME=VALUE or NAME=VALUE,VALUE", text));
    if (text.starts_with("degenerate="))
        throw InputError(
            fmt::format("--set {0}: degenerate is no setting of a cell but of the frames, for all cells; "
                        "give --degenerate {1}",
                        text, text.substr(equals + 1)));
    std::pair<std::string, std::vector<std::string>> set(text.substr(0, equals), {});
    for (const auto& part : CLI::detail::split(text.substr(equals + 1), ','))
        for (auto& value : expand_range(part, "--set " + text)) set.second.push_back(std::move(value));
    return set;
}

} // namespace

void add_set_option(CLI::App& app, Request& request, const std::string& help) {
    app.add_option_function<std::vector<std::string>>(
           "--set",
           [&request](const std::vector<std::string>& texts) {
               for (const auto& text : texts) request.sets.push_back(parse_set(text));
           },
           help)
        ->expected(1)
        ->take_all()
        ->option_text("NAME=VALUE,...");
}

} // namespace tandem
