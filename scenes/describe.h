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
struct JsonLocation {
    std::string file;
    std::string pointer;

    JsonLocation operator/(std::string_view name) const {
        return {file, fmt::format("{}/{}", pointer, name)};
    }
    JsonLocation operator/(std::size_t index) const { return {file, fmt::format("{}/{}", pointer, index)}; }
    std::string text() const { return pointer.empty() ? file : fmt::format("{}: {}", file, pointer); }
    [[noreturn]] void fail(std::string_view what) const;
};

/// Refuses what is no object or has other names than these.
void check_names(const Json& object, const JsonLocation& location, const std::vector<std::string>& allowed);

double number(const Json& json, const JsonLocation& location);
double number(const Json& json, const JsonLocation& location, double least, double most);
double positive(const Json& json, const JsonLocation& location);
/// An integer from `least` to `most`.
double whole(const Json& json, const JsonLocation& location, double least, double most);
std::string text(const Json& json, const JsonLocation& location);
/// The number of a name among choices; `what` they are, for messages.
std::size_t choice(const Json& json, const JsonLocation& location, std::string_view what,
                   const std::vector<std::string>& choices);
/// False when `json` has no such name.
bool flag(const Json& json, const char* name, const JsonLocation& location);
Eigen::Vector3d vector(const Json& json, const JsonLocation& location);

template<std::size_t N>
std::array<double, N> numbers(const Json& json, const JsonLocation& location) {
    if (!json.is_array() || json.size() != N) location.fail(fmt::format("must be {} numbers", N));
    std::array<double, N> values{};
    for (std::size_t i = 0; i < N; ++i) values[i] = number(json[i], location / i);
    return values;
}

} // namespace tandem::description
