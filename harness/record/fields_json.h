// SPDX-License-Identifier: MIT
// Structures as JSON, field by field, every number exactly: what goes from process to process and is kept
// between runs. Records are written by hand.
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

/// to_json and from_json of a structure by all its fields, in their order: one left out does not compile.
#define TANDEM_FIELDS(Type, ...)                                                                             \
    NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Type, __VA_ARGS__)                                                    \
    inline void fields_of(const Type& value) { [[maybe_unused]] const auto& [__VA_ARGS__] = value; }
