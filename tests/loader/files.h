// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"

#include <string>
#include <string_view>

namespace tandem::loader {

/// A folder for the files of this run, made once.
std::string folder();

/// Writes `bytes` into the folder; the path.
std::string write_file(const std::string& name, std::string_view bytes);

/// `text` with the first `from` replaced, which must be there.
std::string replaced(std::string text, std::string_view from, std::string_view to);

/// The mesh every format's example holds; `single`: with coordinates of single precision.
void expect_example(const Mesh& mesh, bool single = false);

/// Reading `bytes` as a file of that name fails at `place`, for a reason that holds `reason`.
void expect_failure(const std::string& name, std::string_view bytes, const std::string& place,
                    std::string_view reason);

} // namespace tandem::loader
