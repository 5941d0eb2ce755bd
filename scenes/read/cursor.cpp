// SPDX-License-Identifier: MIT
#include "scenes/read/cursor.h"

#include "base/error.h"

#include <fmt/format.h>
#include <limits>

namespace tandem::read {

void Cursor::check_count(std::uint64_t n, std::size_t, std::size_t bytes, std::string_view what) const {
    const std::uint64_t left = (bytes_.size() - at_) / bytes;
    if (n > left || n > std::numeric_limits<std::uint32_t>::max())
        fail(fmt::format("{} {} announced, but the rest of the data can contain at most {}", n, what, left),
             "correct the count or export the file again");
}

void Cursor::fail(std::string_view what, std::string_view remedy) const {
    throw InputError(fmt::format("{}: byte {}: {}; {}", location_, value_, what, remedy));
}

void Cursor::fail_end(std::string_view what) const {
    fail(fmt::format("the data ends before {}", what), "it is truncated: copy or export it again");
}

void Cursor::fail_finite(std::string_view what) const {
    fail(fmt::format("{} is not finite", what), "repair the mesh");
}

} // namespace tandem::read
