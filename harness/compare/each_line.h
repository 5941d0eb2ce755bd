// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace tandem::compare {

/// Calls `take` with the text of every line of a file of records that has an end, and its number from 1.
/// Whether a last one without an end followed: cut off, or still written. Throws InputError.
bool each_line(const std::string& path, const std::function<void(const std::string&, std::size_t)>& take);

} // namespace tandem::compare
