// SPDX-License-Identifier: MIT
// Types that several parts of a record share.
#pragma once

#include "harness/fields/field.h"

#include <cstdint>

namespace tandem::record_parts {

Type hex();         ///< of hex_text()
Type count();       ///< a number of things
Type known_count(); ///< a number of things, or null
Type counts();      ///< one a frame
Type samples();     ///< nanoseconds, one a replay
Type settings_type();
Type pattern_of_digest(); ///< a text of 16 hexadecimal digits

/// 16 hexadecimal digits.
std::string hex_text(std::uint64_t value);

/// A range of frames, both inclusive.
struct FirstAndLast {
    std::size_t first = 0, last = 0;
};
const Fields<FirstAndLast>& frames_fields();

/// The rule that samples come with all statistics, and no samples with none.
Type summarised(const Type& object);

/// The rules of a record over several of its fields.
Type with_record_rules(const Type& record);

} // namespace tandem::record_parts
