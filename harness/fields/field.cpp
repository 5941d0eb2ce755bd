// SPDX-License-Identifier: MIT
#include "harness/fields/field.h"

#include <fmt/format.h>
#include <stdexcept>
#include <utility>

namespace tandem::record_parts {

namespace {

Type simple(const char* name) { return {.schema = {{"type", name}}}; }

/// The same type where its fields are no columns, since they have several values or no fixed name.
Type within(const Type& type, Json schema) { return {std::move(schema), type.definitions}; }

/// Throws std::logic_error for a name that has another definition already.
void add_definitions(Json& to, const Json& definitions) {
    for (const auto& [name, schema] : definitions.items()) {
        if (to.contains(name) && to[name] != schema)
            throw std::logic_error(fmt::format("two definitions of {} in a schema", name));
        to[name] = schema;
    }
}

/// The type of a column for a field of that schema: its only type besides null.
std::string column_type(const Type& type) {
    const auto reference = type.schema.value("$ref", "");
    const auto& schema =
        reference.empty() ? type.schema : type.definitions.at(reference.substr(reference.rfind('/') + 1));
    if (schema.contains("enum")) return "text";
    const auto types = schema.value("type", Json());
    for (const auto* name : {"integer", "number", "boolean", "string"})
        if (types == name || types == Json{name, "null"})
            return std::string(name) == "string" ? "text" : name;
    throw std::logic_error("a column has a single value");
}

} // namespace

Type Type::with(const std::string& keyword, Json value) const {
    auto result = *this;
    result.schema[keyword] = std::move(value);
    return result;
}

Type Type::without_columns() const { return within(*this, schema); }

Type any_text() { return simple("string"); }
Type text() { return any_text().with("minLength", 1); }
Type text_like(const std::string& pattern) { return any_text().with("pattern", pattern); }
Type boolean() { return simple("boolean"); }
Type number() { return simple("number"); }

namespace {

/// A whole bound without a decimal point.
Json bound(double value) {
    const auto whole = static_cast<std::int64_t>(value);
    return static_cast<double>(whole) == value ? Json(whole) : Json(value);
}

} // namespace

Type number_from(double minimum) { return number().with("minimum", bound(minimum)); }
Type number_above(double minimum) { return number().with("exclusiveMinimum", bound(minimum)); }
Type integer_from(int minimum) { return simple("integer").with("minimum", minimum); }
Type constant(Json value) { return {.schema = {{"const", std::move(value)}}}; }
Type one_of(Json values) { return {.schema = {{"enum", std::move(values)}}}; }

Type array_of(const Type& element) { return within(element, {{"type", "array"}, {"items", element.schema}}); }

Type map_of(const Type& element, const std::string& names) {
    Json schema{{"type", "object"}};
    if (!names.empty()) schema["propertyNames"] = {{"pattern", names}};
    schema["additionalProperties"] = element.schema;
    return within(element, schema);
}

Type nullable(const Type& type) {
    auto result = type;
    if (type.schema.contains("type"))
        result.schema["type"] = {type.schema["type"], "null"};
    else
        result.schema = {{"anyOf", {{{"type", "null"}}, type.schema}}};
    return result;
}

Type definition(const std::string& name, const Type& type) {
    auto result = type;
    add_definitions(result.definitions, {{name, type.schema}});
    result.schema = {{"$ref", "#/definitions/" + name}};
    return result;
}

Json absent() { return Json::value_t::discarded; }

Json known_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }
Json known_or_null(std::int64_t value) { return value < 0 ? Json() : Json(value); }

ObjectType::ObjectType(const std::string& meaning) {
    type_.schema = {{"type", "object"}};
    if (!meaning.empty()) type_.schema["description"] = meaning;
    type_.schema.update(
        {{"additionalProperties", false}, {"required", Json::array()}, {"properties", Json::object()}});
}

void ObjectType::add(const std::string& name, const Type& type, const std::string& meaning,
                     const Occurrence& occurrence) {
    auto& properties = type_.schema["properties"];
    if (properties.contains(name)) throw std::logic_error(fmt::format("two fields {} of an object", name));
    properties[name] = meaning.empty() ? type.schema : type.with("description", meaning).schema;
    const bool is_newest = occurrence.since >= record_schema;
    if (occurrence.since > 0) {
        const auto before = is_newest ? "records from before it have none"
                                      : fmt::format("null or left out before schema {}", occurrence.since);
        auto& description = properties[name]["description"];
        description = fmt::format("{}; {}", description.get<std::string>(), before);
        properties[name]["since"] = occurrence.since; // a keyword of ours, which validators ignore
    }
    if (!occurrence.optional && !is_newest) type_.schema["required"].push_back(name);
    add_definitions(type_.definitions, type.definitions);
    if (!occurrence.column.empty()) type_.columns.push_back({occurrence.column, {name}, column_type(type)});
    for (auto column : type.columns) {
        column.path.insert(column.path.begin(), name);
        type_.columns.push_back(std::move(column));
    }
}

Type ObjectType::type() const {
    auto result = type_;
    if (result.schema["required"].empty()) result.schema.erase("required");
    return result;
}

} // namespace tandem::record_parts
