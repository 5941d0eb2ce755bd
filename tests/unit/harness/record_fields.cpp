// SPDX-License-Identifier: MIT
#include "harness/fields/field.h"
#include "harness/record/schema.h"
#include "tests/support/test.h"

#include <stdexcept>

namespace tandem::record_parts {
namespace {

struct Sphere {
    std::string name;
    std::optional<double> radius;
    std::int64_t triangles = -1;
    bool is_older = false;
};

const Fields<Sphere>& sphere_fields() {
    static const Fields<Sphere> fields{{"name", text(), "its name", &Sphere::name, {.column = "sphere"}},
                                       {"radius", nullable(number_above(0)), "metres", &Sphere::radius},
                                       {"triangles",
                                        definition("known", nullable(integer_from(0))),
                                        "of its surface",
                                        [](auto& s) { return known_or_null(s.triangles); },
                                        {.column = "triangles"}},
                                       {"colour",
                                        one_of({"red", "green"}),
                                        "",
                                        [](auto& s) { return s.is_older ? absent() : Json("red"); },
                                        {.optional = true}}};
    return fields;
}

TEST(RecordFields, AreWrittenInTheirOrder) {
    EXPECT_EQ(sphere_fields().write({"a", 2.5, 80}).dump(),
              R"({"name":"a","radius":2.5,"triangles":80,"colour":"red"})");
}

TEST(RecordFields, UnknownValuesAreNullAndAbsentFieldsAreLeftOut) {
    EXPECT_EQ(sphere_fields().write({"a", {}, -1, true}).dump(),
              R"({"name":"a","radius":null,"triangles":null})");
    EXPECT_TRUE(known_or_null(std::string()).is_null());
    EXPECT_EQ(known_or_null(std::int64_t{0}), 0);
}

TEST(RecordFields, SchemaHasTypesMeaningsAndRequiredFields) {
    const auto type = sphere_fields().type("a sphere");
    EXPECT_EQ(type.schema.dump(),
              R"({"type":"object","description":"a sphere","additionalProperties":false,)"
              R"("required":["name","radius","triangles"],"properties":{)"
              R"("name":{"type":"string","minLength":1,"description":"its name"},)"
              R"("radius":{"type":["number","null"],"exclusiveMinimum":0,"description":"metres"},)"
              R"("triangles":{"$ref":"#/definitions/known","description":"of its surface"},)"
              R"("colour":{"enum":["red","green"]}}})");
    EXPECT_EQ(type.definitions.dump(), R"({"known":{"type":["integer","null"],"minimum":0}})");
}

TEST(RecordFields, FieldsSinceTheNewestSchemaAreOptional) {
    const auto value = [](auto&) { return Json(); };
    const Fields<Sphere> fields{
        {"old", boolean(), "a", value, {.since = record_schema - 1}},
        {"new", boolean().with("description", "b"), "", value, {.since = record_schema}}};
    const auto schema = fields.type("").schema;
    EXPECT_EQ(schema["required"], Json{"old"});
    EXPECT_EQ(schema["properties"]["old"]["description"], "a; null or left out before schema 3");
    EXPECT_EQ(schema["properties"]["new"]["description"], "b; records from before it have none");
    EXPECT_EQ(schema["properties"]["new"]["since"], record_schema);
}

TEST(RecordFields, MembersAreReadBack) {
    const Fields<Sphere> fields{member("name", &Sphere::name), member("radius", &Sphere::radius)};
    Sphere read;
    fields.take(read, fields.write({"a", 2.5}));
    EXPECT_EQ(read.name, "a");
    EXPECT_EQ(read.radius, 2.5);
    EXPECT_THROW(fields.take(read, {{"name", "b"}}), nlohmann::json::exception);
}

TEST(RecordFields, ColumnsHavePathsAndTypes) {
    const Fields<Sphere> outer{
        {"body", nullable(sphere_fields().type("")), "", [](auto&) { return Json(); }},
        {"other", sphere_fields().type("").without_columns(), "", [](auto&) { return Json(); }},
        {"more", array_of(sphere_fields().type("")), "", [](auto&) { return Json(); }}};
    EXPECT_EQ(columns_text(outer.type("")),
              "{\n  \"columns\": [\n"
              "    {\"column\": \"sphere\", \"path\": [\"body\", \"name\"], \"type\": \"text\"},\n"
              "    {\"column\": \"triangles\", \"path\": [\"body\", \"triangles\"], \"type\": \"integer\"}\n"
              "  ]\n}\n");
}

TEST(RecordFields, MistakesOfDeclarationsThrow) {
    const auto nothing = [](auto&) { return Json(); };
    const Fields<Sphere> twice{{"a", boolean(), "", nothing}, {"a", boolean(), "", nothing}};
    EXPECT_THROW(twice.type(""), std::logic_error);
    const Fields<Sphere> list{{"a", array_of(boolean()), "", nothing, {.column = "a"}}};
    EXPECT_THROW(list.type(""), std::logic_error);
    const Fields<Sphere> definitions{{"a", definition("d", boolean()), "", nothing},
                                     {"b", definition("d", number()), "", nothing}};
    EXPECT_THROW(definitions.type(""), std::logic_error);
    const Fields<Sphere> columns{{"a", boolean(), "", nothing, {.column = "c"}},
                                 {"b", boolean(), "", nothing, {.column = "c"}}};
    EXPECT_THROW(columns_text(columns.type("")), std::logic_error);
}

TEST(RecordFields, LongJsonIsBrokenBetweenItsParts) {
    EXPECT_EQ(readable({{"a", {1, 2}}, {"b", Json::object()}}), "{\"a\": [1, 2], \"b\": {}}\n");
    const std::string words(150, 'x');
    EXPECT_EQ(readable({{"a", words}}), "{\"a\": \"" + words + "\"}\n");
    EXPECT_EQ(readable({{"a", {{"b", words}}}, {"c", 1}}),
              "{\n  \"a\": {\"b\": \"" + words + "\"},\n  \"c\": 1\n}\n");
}

} // namespace
} // namespace tandem::record_parts
