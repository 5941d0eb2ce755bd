// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

namespace nlohmann {

/// Nothing is null.
template<class T>
struct adl_serializer<std::optional<T>> {
    static void to_json(json& to, const std::optional<T>& value) { to = value ? json(*value) : json(); }
    static void from_json(const json& from, std::optional<T>& value) {
        value = from.is_null() ? std::nullopt : std::optional<T>(from.get<T>());
    }
};

} // namespace nlohmann
