// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tandem {

/// Bad use or bad input. The message is one line: what is wrong, where (file:line for input) and what to do.
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Output that cannot be written after work has begun; the input is not the cause. One line: what and why.
struct OutputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The candidate with the smallest edit distance to `name`; empty when none is within two edits.
std::string nearest(std::string_view name, std::span<const std::string> candidates);

/// "unknown WHAT 'NAME'; the nearest is 'X' (there are: A, B, C)": the usual InputError message for a wrong
/// name. Without a nearest one, the middle is missing.
std::string unknown(std::string_view what, std::string_view name, std::span<const std::string> candidates);

} // namespace tandem
