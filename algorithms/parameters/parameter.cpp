// SPDX-License-Identifier: MIT
#include "algorithms/parameters/parameter.h"

#include "base/error.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace tandem {

namespace {

/// Accepts integers such as 10000000 and 1e7.
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

const Parameter& named(std::span<const Parameter* const> parameters, const std::string& name,
                       std::string_view algorithm) {
    std::vector<std::string> names;
    for (const auto* parameter : parameters) {
        if (parameter->name == name) return *parameter;
        names.emplace_back(parameter->name);
    }
    throw InputError(unknown(fmt::format("setting of {}", algorithm), name, names));
}

} // namespace

std::string Parameter::text(std::int64_t value) const {
    if (is_length()) return fmt::format("{}", std::bit_cast<double>(value));
    for (const auto& word : choices())
        if (word.value == value) return std::string(word.text);
    return std::to_string(value);
}

/// A NaN fails the comparisons.
std::int64_t Parameter::parse_length(const std::string& text) const {
    double length = 0;
    const auto* end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, length);
    if (result.ec == std::errc{} && result.ptr == end && length >= 0 && length <= longest)
        return number_of(length + 0.0); // -0 becomes 0
    throw InputError(fmt::format("setting {}={} is impossible; give a length from 0 to {}, such as 0.01",
                                 name, text, longest));
}

std::int64_t Parameter::parse(const std::string& text) const {
    if (is_length()) return parse_length(text);
    std::vector<std::string_view> allowed;
    for (const auto& word : choices()) {
        if (word.text == text) return word.value;
        allowed.push_back(word.text);
    }
    std::int64_t number = 0;
    if (takes_integers() && parse_integer(text, number) && number >= least && number <= most) return number;
    const auto listed = fmt::format("{}", fmt::join(allowed, ", "));
    throw InputError(fmt::format("setting {}={} is impossible; {}", name, text,
                                 !takes_integers()
                                     ? fmt::format("choose one of {}", listed)
                                     : fmt::format("give an integer from {} to {}{}{}", least, most,
                                                   allowed.empty() ? "" : ", or ", listed)));
}

Settings::Settings(std::span<const Parameter* const> parameters) {
    for (const auto* parameter : parameters) values_[parameter->name] = {parameter, parameter->initial};
}

std::string Settings::text(std::string_view name) const {
    const auto& [parameter, value] = values_.at(name);
    return parameter->text(value);
}

SettingTexts Settings::texts() const {
    SettingTexts texts;
    for (const auto& [name, assignment] : values_)
        texts.emplace(name, assignment.parameter->text(assignment.value));
    return texts;
}

SettingTexts Preset::texts() const {
    SettingTexts texts;
    for (const auto& [parameter, value] : values) texts.emplace(parameter->name, parameter->text(value));
    return texts;
}

/// Starts with the defaults, which the preset overrides; `given` overrides both.
Settings resolve(std::span<const Parameter* const> parameters, std::span<const Assignment> preset,
                 const SettingTexts& given, std::string_view algorithm) {
    Settings settings(parameters);
    for (const auto& assignment : preset) {
        named(parameters, std::string(assignment.parameter->name), algorithm);
        settings.set(assignment);
    }
    for (const auto& [name, value] : given) {
        const auto& parameter = named(parameters, name, algorithm);
        settings.set({&parameter, parameter.parse(value)});
    }
    return settings;
}

} // namespace tandem
