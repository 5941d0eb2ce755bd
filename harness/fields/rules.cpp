// SPDX-License-Identifier: MIT
// The rules of records that concern several fields, as JSON Schema.
#include "harness/fields/types.h"

namespace tandem::record_parts {

namespace {

constexpr auto record_rules = R"([
    {"if": {"properties": {"status": {"const": "failed"}}},
     "then": {"properties": {"failure": {"type": "string"}, "work": {"type": "null"},
                             "preparation": {"type": "null"}, "error": {"type": "null"}}},
     "else": {"properties": {"failure": {"type": "null"}, "kernels": {"minItems": 1},
                             "total_ns": {"type": "object"},
                             "breakdown_ns": {"type": "object", "required": ["median"]},
                             "work": {"type": "object"}, "preparation": {"type": "object"},
                             "error": {"type": "object"}}}},
    {"if": {"properties": {"status": {"const": "ok"}}},
     "then": {"properties": {"agreement": {"properties": {"missing": {"const": 0}, "extra": {"const": 0},
                                                          "contact_frames_wrong": {"const": 0}}}}}}])";

constexpr auto summary_rule = R"({
    "description": "samples come with all five statistics, no samples with none",
    "if": {"type": "object", "properties": {"samples": {"maxItems": 0}}},
    "then": {"not": {"anyOf": [{"required": ["median"]}, {"required": ["q1"]}, {"required": ["q3"]},
                               {"required": ["low"]}, {"required": ["high"]}]}},
    "else": {"required": ["median", "q1", "q3", "low", "high"]}})";

} // namespace

Type with_record_rules(const Type& record) { return record.with("allOf", Json::parse(record_rules)); }

Type summarised(const Type& object) {
    const auto rule = definition("summarised", {.schema = Json::parse(summary_rule)});
    auto result = object.with("allOf", Json::array({rule.schema}));
    result.definitions.update(rule.definitions);
    return result;
}

} // namespace tandem::record_parts
