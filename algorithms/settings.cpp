// SPDX-License-Identifier: MIT
#include "algorithms/settings.h"

#include "scenes/error.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

namespace {

/// Integers may be written 10000000 or 1e7.
bool parse_integer(const std::string& text, std::int64_t& value) {
    const auto* end = text.data() + text.size();
    if (const auto result = std::from_chars(text.data(), end, value);
        result.ec == std::errc{} && result.ptr == end)
        return true;
    double real = 0;
    const auto result = std::from_chars(text.data(), end, real);
    if (result.ec != std::errc{} || result.ptr != end || !(real >= -9e18 && real <= 9e18)) return false;
    value = static_cast<std::int64_t>(real);
    return static_cast<double>(value) == real;
}

std::string checked(const Parameter& parameter, const std::string& value) {
    if (!parameter.choices.empty()) {
        if (std::find(parameter.choices.begin(), parameter.choices.end(), value) != parameter.choices.end())
            return value;
        throw InputError(fmt::format("setting {}={} is impossible; choose one of {}", parameter.name, value,
                                     fmt::join(parameter.choices, ", ")));
    }
    std::int64_t number = 0;
    if (!parse_integer(value, number) || number < parameter.least || number > parameter.most)
        throw InputError(fmt::format("setting {}={} is impossible; give an integer from {} to {}",
                                     parameter.name, value, parameter.least, parameter.most));
    return std::to_string(number);
}

} // namespace

Settings resolve(std::span<const Parameter> parameters, const Settings& preset, const Settings& given,
                 std::string_view algorithm) {
    Settings settings;
    std::vector<std::string> names;
    for (const auto& parameter : parameters) {
        settings[parameter.name] = parameter.initial;
        names.push_back(parameter.name);
    }
    for (const auto* source : {&preset, &given}) {
        for (const auto& [name, value] : *source) {
            const auto found = std::find_if(parameters.begin(), parameters.end(),
                                            [&name = name](auto& p) { return p.name == name; });
            if (found == parameters.end())
                throw InputError(unknown(fmt::format("setting of {}", algorithm), name, names));
            settings[name] = checked(*found, value);
        }
    }
    return settings;
}

std::int64_t integer(const Settings& settings, const std::string& name) {
    return std::stoll(settings.at(name));
}

} // namespace tandem
