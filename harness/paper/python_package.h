// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string_view>

namespace tandem {

/// A file of the Python package python/tandem, or a table of results/paper as its data.
struct PackageFile {
    std::string_view path; ///< as it is imported, tandem/...
    std::string_view text;
};

/// Made by CMakeLists.txt.
std::span<const PackageFile> python_package();

} // namespace tandem
