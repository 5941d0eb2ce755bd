// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

/// Reading of values from scene descriptions and plans; every function throws InputError that names the
/// place.
namespace tandem::description {

using Json = nlohmann::json;

/// No setting is larger.
constexpr double largest = 1e9;

/// A place in the description, for messages: "file.json: /bodies/3/pose: ".
struct Place {
    std::string file;
    std::string pointer;

    Place operator/(std::string_view name) const { return {file, fmt::format("{}/{}", pointer, name)}; }
    Place operator/(std::size_t index) const { return {file, fmt::format("{}/{}", pointer, index)}; }
    std::string text() const { return pointer.empty() ? file : fmt::format("{}: {}", file, pointer); }
    [[noreturn]] void fail(std::string_view what) const;
};

/// Refuses what is no object or has other names than these.
void check_names(const Json& object, const Place& place, const std::vector<std::string>& allowed);

double number(const Json& json, const Place& place);
double number(const Json& json, const Place& place, double least, double most);
double positive(const Json& json, const Place& place);
/// An integer from `least` to `most`.
double whole(const Json& json, const Place& place, double least, double most);
std::string text(const Json& json, const Place& place);
/// The number of a name among choices; `what` they are, for messages.
std::size_t choice(const Json& json, const Place& place, std::string_view what,
                   const std::vector<std::string>& choices);
/// False when `json` has no such name.
bool flag(const Json& json, const char* name, const Place& place);
Eigen::Vector3d vector(const Json& json, const Place& place);

template<std::size_t N>
std::array<double, N> numbers(const Json& json, const Place& place) {
    if (!json.is_array() || json.size() != N) place.fail(fmt::format("must be {} numbers", N));
    std::array<double, N> values{};
    for (std::size_t i = 0; i < N; ++i) values[i] = number(json[i], place / i);
    return values;
}

} // namespace tandem::description
