// SPDX-License-Identifier: MIT
// Converts structures to JSON field by field, with every number exact. Child processes and files kept between
// runs use this form. field.h declares the fields of records.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

namespace nlohmann {

/// An empty optional is null in JSON.
template<class T>
struct adl_serializer<std::optional<T>> {
    template<class Json>
    static void to_json(Json& to, const std::optional<T>& value) {
        to = value ? Json(*value) : Json();
    }
    template<class Json>
    static void from_json(const Json& from, std::optional<T>& value) {
        value = from.is_null() ? std::nullopt : std::optional<T>(from.template get<T>());
    }
};

} // namespace nlohmann

/// Defines to_json and from_json of a structure, for any kind of nlohmann::basic_json. List all fields in
/// order: a missing field does not compile.
#define TANDEM_FIELDS(Type, ...)                                                                             \
    template<class Json>                                                                                     \
    requires nlohmann::detail::is_basic_json<Json>::value void to_json(Json& nlohmann_json_j,                \
                                                                       const Type& nlohmann_json_t) {        \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_TO, __VA_ARGS__))                             \
    }                                                                                                        \
    template<class Json>                                                                                     \
    requires nlohmann::detail::is_basic_json<Json>::value void from_json(const Json& nlohmann_json_j,        \
                                                                         Type& nlohmann_json_t) {            \
        NLOHMANN_JSON_EXPAND(NLOHMANN_JSON_PASTE(NLOHMANN_JSON_FROM, __VA_ARGS__))                           \
    }                                                                                                        \
    inline void fields_of(const Type& value) { [[maybe_unused]] const auto& [__VA_ARGS__] = value; }
