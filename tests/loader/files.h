// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <string>
#include <string_view>

namespace tandem::loader {

/// Folder for the files of this run; created on the first call.
std::string folder();

/// Writes `bytes` to a file in the folder and returns its path.
std::string write_file(const std::string& name, std::string_view bytes);

/// `text` with the first occurrence of `from` replaced; `from` must occur.
std::string replaced(std::string text, std::string_view from, std::string_view to);

/// Expects the example mesh of every format; `single`: with single-precision coordinates.
void expect_example(const Mesh& mesh, bool single = false);

/// Expects the example with pressures 0, 0.5, 1.25, 0, 3e7 and 0.125 at its vertices.
void expect_pressures(const std::string& name, std::string_view bytes, bool single = false);

/// Expects that reading `bytes` as a file of that name fails at `location` with a message that contains
/// `reason`.
void expect_failure(const std::string& name, std::string_view bytes, const std::string& location,
                    std::string_view reason);

} // namespace tandem::loader
