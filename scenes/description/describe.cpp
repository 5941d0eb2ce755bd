// SPDX-License-Identifier: MIT
#include "scenes/description/describe.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace tandem::description {

void JsonLocation::fail(std::string_view what) const {
    throw InputError(fmt::format("{}: {}", text(), what));
}

void check_names(const Json& object, const JsonLocation& location, const std::vector<std::string>& allowed) {
    if (!object.is_object()) location.fail("must be an object");
    for (const auto& [name, value] : object.items())
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
            location.fail(unknown("name", name, allowed));
}

double number(const Json& json, const JsonLocation& location) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) location.fail("must be a finite number");
    return json.get<double>();
}

double number(const Json& json, const JsonLocation& location, double least, double most) {
    const double value = number(json, location);
    if (!(value >= least && value <= most)) location.fail(fmt::format("must be from {} to {}", least, most));
    return value;
}

double positive(const Json& json, const JsonLocation& location) {
    const double value = number(json, location);
    if (!(value > 0)) location.fail("must be above 0");
    return value;
}

double whole(const Json& json, const JsonLocation& location, double least, double most) {
    const double value = number(json, location);
    if (!(value >= least && value <= most) || value != std::floor(value))
        location.fail(fmt::format("must be an integer from {:g} to {:g}", least, most));
    return value;
}

std::string text(const Json& json, const JsonLocation& location) {
    if (!json.is_string()) location.fail("must be a string");
    return json.get<std::string>();
}

std::size_t choice(const Json& json, const JsonLocation& location, std::string_view what,
                   const std::vector<std::string>& choices) {
    const auto name = text(json, location);
    const auto found = std::find(choices.begin(), choices.end(), name);
    if (found == choices.end()) location.fail(unknown(what, name, choices));
    return static_cast<std::size_t>(found - choices.begin());
}

bool flag(const Json& json, const char* name, const JsonLocation& location) {
    if (!json.contains(name)) return false;
    if (!json[name].is_boolean()) (location / name).fail("must be true or false");
    return json[name].get<bool>();
}

Eigen::Vector3d vector(const Json& json, const JsonLocation& location) {
    const auto v = numbers<3>(json, location);
    return {v[0], v[1], v[2]};
}

} // namespace tandem::description
