// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/scene.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

/// Functions that read values from scene descriptions and plans. Each throws InputError with the location.
namespace tandem::description {

using Json = nlohmann::json;

/// Upper limit of settings without a limit of their own.
constexpr double largest = 1e9;

/// A location in the description, for messages: "file.json: /bodies/3/pose: ".
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

/// Throws InputError unless `object` is a JSON object whose names are all in `allowed`.
void check_names(const Json& object, const JsonLocation& location, const std::vector<std::string>& allowed);

double number(const Json& json, const JsonLocation& location);
double number(const Json& json, const JsonLocation& location, double least, double most);
double positive(const Json& json, const JsonLocation& location);
/// An integer from `least` to `most`.
double whole(const Json& json, const JsonLocation& location, double least, double most);
std::string text(const Json& json, const JsonLocation& location);
/// Index of the name in `choices`; messages call a choice `what`.
std::size_t choice(const Json& json, const JsonLocation& location, std::string_view what,
                   const std::vector<std::string>& choices);
/// The boolean of that name; false when `json` has none.
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
