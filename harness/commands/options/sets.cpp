// SPDX-License-Identifier: MIT
#include "harness/commands/options/sets.h"

#include "harness/plans/ranges.h"
#include "base/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace tandem {

std::vector<std::pair<std::string, std::vector<std::string>>>
parse_sets(const std::vector<std::string>& texts) {
    std::vector<std::pair<std::string, std::vector<std::string>>> sets;
    for (const auto& text : texts) {
        const auto equals = text.find('=');
        if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
            throw InputError(fmt::format("--set {}: give NAME=VALUE or NAME=VALUE,VALUE", text));
        if (text.starts_with("degenerate="))
            throw InputError(
                fmt::format("--set {0}: degenerate is no setting of a cell but of the frames, for all cells; "
                            "give --degenerate {1}",
                            text, text.substr(equals + 1)));
        auto& values = sets.emplace_back(text.substr(0, equals), std::vector<std::string>{}).second;
        for (const auto& part : CLI::detail::split(text.substr(equals + 1), ','))
            for (auto& value : expand_range(part, "--set " + text)) values.push_back(std::move(value));
    }
    return sets;
}

} // namespace tandem
