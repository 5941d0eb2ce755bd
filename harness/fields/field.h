// SPDX-License-Identifier: MIT
// A field of a record is declared once: name, type, meaning and value. The writer, the schema, the
// documentation and the columns of tables come from this declaration.
#pragma once

#include "harness/fields/fields_json.h"

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace tandem {

/// The version of results/record.schema.json.
inline constexpr int record_schema = 4;

} // namespace tandem

namespace tandem::record_parts {

using Json = nlohmann::ordered_json;

/// A column of the table of cells. `path`: the names of the fields that lead to its value.
struct FieldColumn {
    std::string name;
    std::vector<std::string> path;
    std::string type; ///< "integer", "number", "boolean" or "text"
};

/// The type of a field: a JSON Schema.
struct Type {
    Json schema;
    Json definitions = Json::object();     ///< schemas that `schema` refers to, by name
    std::vector<FieldColumn> columns = {}; ///< of the fields of an object

    /// The same type with one more keyword, such as "minimum".
    Type with(const std::string& keyword, Json value) const;
    /// The same type, for an object whose fields are columns where it is used elsewhere.
    Type without_columns() const;
};

Type any_text();
Type text(); ///< not empty
Type text_like(const std::string& pattern);
Type boolean();
Type number();
Type number_from(double minimum);
Type number_above(double minimum);
Type integer_from(int minimum);
Type constant(Json value);
Type one_of(Json values); ///< an array of texts
Type array_of(const Type& element);
/// An object with any names that match `names`; an empty pattern matches every name.
Type map_of(const Type& element, const std::string& names);
Type nullable(const Type& type);
/// A type that the schema has once, as a definition. `name` is unique among different types.
Type definition(const std::string& name, const Type& type);

/// How a field occurs.
struct Occurrence {
    bool optional = false; ///< some records lack it
    int since = 0; ///< first schema with it: records of older ones, and older ones of the newest, lack it
    std::string column = {}; ///< the table of cells has it as this column
};

/// The value of an optional field that this object lacks.
Json absent();

/// Null for an empty text or a negative number, which stand for unknown values.
Json known_or_null(const std::string& text);
Json known_or_null(std::int64_t value);

/// A field of an object that is made from a `From`. `meaning` is empty where that of the type is enough.
/// `take` sets the value again; empty where no one reads it back.
template<class From>
struct Field {
    using Value = std::function<Json(const From&)>;
    using Take = std::function<void(From&, const Json&)>;

    Field(std::string called, Type of, std::string meant, Value made, Occurrence occurs = {}, Take taken = {})
        : name(std::move(called)),
          type(std::move(of)),
          meaning(std::move(meant)),
          value(std::move(made)),
          occurrence(std::move(occurs)),
          take(std::move(taken)) {}

    std::string name;
    Type type;
    std::string meaning;
    Value value;
    Occurrence occurrence;
    Take take;
};

/// A field that is a member, which Fields::take() can read.
template<class From, class Value>
Field<From> member(const std::string& name, const Type& type, const std::string& meaning, Value From::*at,
                   const Occurrence& occurrence = {}) {
    return {name,       type,
            meaning,    [at](const From& from) { return Json(from.*at); },
            occurrence, [at](From& from, const Json& json) { json.get_to(from.*at); }};
}

/// A member that another process or run needs and no record has.
template<class From, class Value>
Field<From> member(const std::string& name, Value From::*at) {
    return member(name, Type{}, "", at);
}

/// The type of an object, field by field.
class ObjectType {
public:
    explicit ObjectType(const std::string& meaning);
    /// Throws std::logic_error for a second field of that name, and for a column that is no single value.
    void add(const std::string& name, const Type& type, const std::string& meaning,
             const Occurrence& occurrence);
    Type type() const;

private:
    Type type_;
};

/// All fields of an object, in the order of the record.
template<class From>
class Fields {
public:
    Fields(std::initializer_list<Field<From>> fields) : fields_(fields) {}
    explicit Fields(std::vector<Field<From>> fields) : fields_(std::move(fields)) {}

    /// The same fields, then those of `more`.
    Fields with(const Fields& more) const {
        auto all = fields_;
        all.insert(all.end(), more.fields_.begin(), more.fields_.end());
        return Fields(std::move(all));
    }

    Json write(const From& from) const {
        Json json = Json::object();
        for (const auto& field : fields_)
            if (auto value = field.value(from); !value.is_discarded()) json[field.name] = std::move(value);
        return json;
    }

    /// Sets the members that write() wrote, all of which are there. Throws nlohmann::json::exception.
    void take(From& from, const Json& json) const {
        for (const auto& field : fields_) field.take(from, json.at(field.name));
    }

    /// The same fields of an object that has a `From`, which `part` returns.
    template<class Whole>
    Fields<Whole> of(const From& (*part)(const Whole&)) const {
        std::vector<Field<Whole>> fields;
        for (const auto& field : fields_)
            fields.push_back({field.name, field.type, field.meaning,
                              [value = field.value, part](const Whole& whole) { return value(part(whole)); },
                              field.occurrence});
        return Fields<Whole>(std::move(fields));
    }

    /// An object with these fields and no others.
    Type type(const std::string& meaning) const {
        ObjectType object(meaning);
        for (const auto& field : fields_) object.add(field.name, field.type, field.meaning, field.occurrence);
        return object.type();
    }

private:
    std::vector<Field<From>> fields_;
};

/// One object for each element of `range`.
template<class From, class Range>
Json array_json(const Fields<From>& fields, const Range& range) {
    Json json = Json::array();
    for (const auto& element : range) json.push_back(fields.write(element));
    return json;
}

} // namespace tandem::record_parts
