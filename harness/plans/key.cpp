// SPDX-License-Identifier: MIT
#include "harness/plans/key.h"

#include "harness/plans/device_models.h"
#include "harness/plans/cell_session.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace tandem {

namespace {

std::string models_of(const Cell& cell) {
    std::string models;
    for (const auto& info : infos_of(cell)) models += (models.empty() ? "" : "+") + model_of(info);
    return models;
}

/// Settings that came after the first records, with the values that these stand for.
constexpr std::array<std::pair<std::string_view, std::string_view>, 11> later_settings{
    {{"copies", "none"},
     {"first_body_pair", "0"},
     {"most_body_pairs", "0"},
     {"margin", "0"},
     {"motion", "none"},
     {"order", "any"},
     {"pressure_slab", "off"},
     {"rebuild", "8"},
     {"self", "off"},
     {"sizes", "own"},
     {"tree", "body"}}};

bool is_later_default(const std::string& name, const std::string& value) {
    return std::ranges::find(later_settings, std::pair<std::string_view, std::string_view>(name, value))
           != later_settings.end();
}

/// "name=value,..." in the order of names.
std::string settings_key(const SettingTexts& settings) {
    std::string key;
    for (const auto& [name, value] : settings)
        if (!is_later_default(name, value))
            key += fmt::format("{}{}={}", key.empty() ? "" : ",", name, value);
    return key;
}

/// The handling of flawed tetrahedra, when it changes the answer.
std::string handling_key(const Flaws& flaws) {
    return flaws.handling == Degenerate::skip && flaws.any() ? ",degenerate=skip" : "";
}

} // namespace

std::string with_settings(const std::string& before_settings, const SettingTexts& settings) {
    return before_settings + "|" + settings_key(settings);
}

std::string key_of(const Cell& cell, const Settings& settings, const Scene& scene, const FrameRange& range) {
    return with_settings(fmt::format("{}|{}|{}@{:016x}|{}:{}{}", cell.algorithm->name(), models_of(cell),
                                     scene.key, scene.digest, range.first(), range.last(),
                                     handling_key(range.flaws())),
                         settings.texts());
}

} // namespace tandem
