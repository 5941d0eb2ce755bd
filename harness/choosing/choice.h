// SPDX-License-Identifier: MIT
#pragma once

#include "harness/choosing/race.h"
#include "harness/fields/field.h"

namespace tandem {

class FrameRange;

/// "chosen" of a record: the first of `ranking` (Race::run), compared on `frames` frames of the range just
/// now.
nlohmann::ordered_json choice_json(const Race& race, const std::vector<std::size_t>& ranking,
                                   const std::string& scene, std::size_t first, std::size_t frames);

/// Whether the chosen one of that JSON is this cell.
bool is_chosen(const Cell& cell, const nlohmann::ordered_json& choice);

namespace record_parts {

/// The type of choice_json().
Type choice_type(const std::string& meaning);

} // namespace record_parts

} // namespace tandem
