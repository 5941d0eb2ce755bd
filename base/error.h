// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tandem {

/// Bad use or bad input: one line that says what, where (file:line for input) and what to do.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Output that cannot be written once work has begun, which is no fault of the input: what and why.
struct OutputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The candidate with the smallest edit distance to `name`; empty when there are no candidates.
std::string nearest(std::string_view name, std::span<const std::string> candidates);

/// "unknown WHAT 'NAME'; the nearest is 'X' (there are: A, B, C)"; the text of the usual InputError.
std::string unknown(std::string_view what, std::string_view name, std::span<const std::string> candidates);

} // namespace tandem
