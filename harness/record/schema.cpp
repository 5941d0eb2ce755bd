// SPDX-License-Identifier: MIT
#include "harness/record/schema.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <stdexcept>

namespace tandem::record_parts {

namespace {

constexpr std::size_t widest_line = 150;

/// JSON on one line, with blanks behind colons and commas.
std::string on_one_line(const Json& json) {
    if (!json.is_structured()) return json.dump();
    std::string text;
    for (const auto& [name, part] : json.items()) {
        if (!text.empty()) text += ", ";
        if (json.is_object()) text += Json(name).dump() + ": ";
        text += on_one_line(part);
    }
    return json.is_object() ? "{" + text + "}" : "[" + text + "]";
}

bool can_break(const Json& json) {
    return json.is_structured() && std::ranges::any_of(json, [](const auto& part) {
               return part.is_object() || (part.is_array() && !part.empty() && part.front().is_structured());
           });
}

/// `used`: characters of the line before the value.
std::string laid_out(const Json& json, std::size_t indent, std::size_t used) {
    auto line = on_one_line(json);
    if (used + line.size() <= widest_line || !can_break(json)) return line;
    const std::string margin(indent + 2, ' ');
    std::string text;
    for (const auto& [name, part] : json.items()) {
        const auto head = margin + (json.is_object() ? Json(name).dump() + ": " : "");
        text += (text.empty() ? "\n" : ",\n") + head + laid_out(part, indent + 2, head.size() + 1);
    }
    text += "\n" + std::string(indent, ' ');
    return json.is_object() ? "{" + text + "}" : "[" + text + "]";
}

std::string schema_text(const char* title, const Type& type) {
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    schema.update(type.schema);
    if (!type.definitions.empty()) schema["definitions"] = type.definitions;
    return readable(schema);
}

} // namespace

std::string readable(const Json& json) { return laid_out(json, 0, 0) + "\n"; }

std::string record_schema_text() { return schema_text("Record of tandem", record_type()); }

std::string verdict_schema_text() { return schema_text("Verdict of tandem", verdict_type()); }

std::string columns_text(const Type& record) {
    Json columns = Json::array();
    std::set<std::string> names;
    for (const auto& column : record.columns) {
        if (!names.insert(column.name).second)
            throw std::logic_error(fmt::format("two columns {} of cells", column.name));
        columns.push_back({{"column", column.name}, {"path", column.path}, {"type", column.type}});
    }
    return readable({{"columns", columns}});
}

} // namespace tandem::record_parts
