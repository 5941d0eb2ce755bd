// SPDX-License-Identifier: MIT
#include "scenes/describe.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace tandem::description {

void Place::fail(std::string_view what) const { throw InputError(fmt::format("{}: {}", text(), what)); }

void check_names(const Json& object, const Place& place, const std::vector<std::string>& allowed) {
    if (!object.is_object()) place.fail("must be an object");
    for (const auto& [name, value] : object.items())
        if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
            place.fail(unknown("name", name, allowed));
}

double number(const Json& json, const Place& place) {
    if (!json.is_number() || !std::isfinite(json.get<double>())) place.fail("must be a finite number");
    return json.get<double>();
}

double number(const Json& json, const Place& place, double least, double most) {
    const double value = number(json, place);
    if (!(value >= least && value <= most)) place.fail(fmt::format("must be from {} to {}", least, most));
    return value;
}

double positive(const Json& json, const Place& place) {
    const double value = number(json, place);
    if (!(value > 0)) place.fail("must be above 0");
    return value;
}

double whole(const Json& json, const Place& place, double least, double most) {
    const double value = number(json, place);
    if (!(value >= least && value <= most) || value != std::floor(value))
        place.fail(fmt::format("must be an integer from {:g} to {:g}", least, most));
    return value;
}

std::string text(const Json& json, const Place& place) {
    if (!json.is_string()) place.fail("must be a string");
    return json.get<std::string>();
}

std::size_t choice(const Json& json, const Place& place, std::string_view what,
                   const std::vector<std::string>& choices) {
    const auto name = text(json, place);
    const auto found = std::find(choices.begin(), choices.end(), name);
    if (found == choices.end()) place.fail(unknown(what, name, choices));
    return static_cast<std::size_t>(found - choices.begin());
}

bool flag(const Json& json, const char* name, const Place& place) {
    if (!json.contains(name)) return false;
    if (!json[name].is_boolean()) (place / name).fail("must be true or false");
    return json[name].get<bool>();
}

Eigen::Vector3d vector(const Json& json, const Place& place) {
    const auto v = numbers<3>(json, place);
    return {v[0], v[1], v[2]};
}

} // namespace tandem::description
