// SPDX-License-Identifier: MIT
#include "scenes/description/describe_settings.h"

#include "scenes/dynamics_settings.h"

#include <algorithm>

namespace tandem::description {

namespace {

/// Settings in one object of a description: pairs of the name in the object and the setting's name.
struct Group {
    const char* name;
    std::vector<std::pair<const char*, const char*>> members;
};

const std::vector<Group>& groups() {
    static const std::vector<Group> all{
        {"solver",
         {{"method", "method"},
          {"iterations", "iterations"},
          {"absolute_tolerance", "absolute_tolerance"},
          {"relative_tolerance", "relative_tolerance"},
          {"warm_start", "warm_start"}}},
        {"stepping",
         {{"pre_stabilize", "pre_stabilize"},
          {"post_stabilize", "post_stabilize"},
          {"bounce", "bounce"},
          {"bound_energy", "bound_energy"},
          {"surface_normals", "surface_normals"},
          {"contact_layer", "contact_layer"},
          {"linear_damping", "linear_damping"},
          {"angular_damping", "angular_damping"},
          {"adaptive_tolerance", "adaptive_tolerance"},
          {"least_step", "least_step"},
          {"couple_contacts", "couple_contacts"}}},
        {"reduction", {{"distance", "merge_distance"}, {"per_pair", "per_pair"}}},
    };
    return all;
}

const DynamicsSetting& setting_named(std::string_view name) {
    const auto all = dynamics_settings();
    return *std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.name == name; });
}

/// The value of a member in the text form of --dynamics.
std::string text_of(const Json& json, const char* name, const JsonLocation& location,
                    const DynamicsSetting& setting) {
    switch (setting.kind) {
    case DynamicsSetting::Kind::real:
        return fmt::format("{}", number(json[name], location / name, setting.least, setting.most));
    case DynamicsSetting::Kind::whole:
        return fmt::format("{:.0f}", whole(json[name], location / name, setting.least, setting.most));
    case DynamicsSetting::Kind::toggle:
        return flag(json, name, location) ? "1" : "0";
    case DynamicsSetting::Kind::word:
        break;
    }
    return setting.words[choice(json[name], location / name, name, setting.words)];
}

/// Sets the value through its text form, so that a description and --dynamics pass the same checks.
void read(const Json& json, const char* name, const JsonLocation& location, std::string_view setting_name,
          Dynamics& dynamics) {
    if (!json.contains(name)) return;
    const auto& setting = setting_named(setting_name);
    setting.set(dynamics, text_of(json, name, location, setting));
}

} // namespace

void read_settings(const Json& json, const JsonLocation& location, Dynamics& dynamics) {
    if (json.contains("gravity")) dynamics.gravity = vector(json["gravity"], location / "gravity");
    read(json, "step", location, "step", dynamics);
    if (json.contains("steps"))
        dynamics.steps = static_cast<std::size_t>(whole(json["steps"], location / "steps", 1, largest));
    for (const auto& group : groups()) {
        if (!json.contains(group.name)) continue;
        const auto& members = json[group.name];
        std::vector<std::string> names;
        for (const auto& [name, setting] : group.members) names.emplace_back(name);
        check_names(members, location / group.name, names);
        for (const auto& [name, setting] : group.members)
            read(members, name, location / group.name, setting, dynamics);
    }
}

} // namespace tandem::description
