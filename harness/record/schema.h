// SPDX-License-Identifier: MIT
// The committed files that are made of the declarations of fields.
#pragma once

#include "harness/fields/field.h"

namespace tandem::record_parts {

/// A line of a cell.
Type record_type();

/// A line of a verdict.
Type verdict_type();

/// The text of results/record.schema.json.
std::string record_schema_text();

/// The text of results/verdict.schema.json.
std::string verdict_schema_text();

/// The text of python/tandem/fields.json: the columns of the table of cells that are fields of a record.
/// Throws std::logic_error for two columns of one name.
std::string columns_text(const Type& record);

/// JSON for readers: a value is on one line if it has at most 150 characters with its indentation, or no
/// part that could be broken.
std::string readable(const Json& json);

} // namespace tandem::record_parts
