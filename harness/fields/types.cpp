// SPDX-License-Identifier: MIT
#include "harness/fields/types.h"

#include <fmt/format.h>

namespace tandem::record_parts {

Type pattern_of_digest() { return text_like("^[0-9a-f]{16}$"); }

Type hex() { return definition("hex", pattern_of_digest().with("description", "64 bits, hexadecimal")); }

Type count() { return definition("count", integer_from(0).with("description", "a number of things")); }

Type known_count() {
    return definition("known",
                      nullable(integer_from(0)).with("description", "a number of things; null when unknown"));
}

Type counts() { return definition("counts", array_of(count()).with("description", "one a frame")); }

Type samples() {
    return definition("samples", array_of(integer_from(0).with("description", "nanoseconds"))
                                     .with("description", "raw samples in order, nanoseconds"));
}

Type settings_type() {
    return map_of(any_text().with("description", "value of the setting, as --set takes it"),
                  "^[a-z][a-z0-9_]*$");
}

std::string hex_text(std::uint64_t value) { return fmt::format("{:016x}", value); }

const Fields<FirstAndLast>& frames_fields() {
    static const Fields<FirstAndLast> fields{
        {"first", count(), "first frame, from 0", &FirstAndLast::first, {.column = "first_frame"}},
        {"last", count(), "last frame, inclusive", &FirstAndLast::last, {.column = "last_frame"}}};
    return fields;
}

} // namespace tandem::record_parts
