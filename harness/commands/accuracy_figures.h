// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Draws figures of records and writes their data, with the Python package python/tandem/error_figures.
class Figures {
public:
    /// Creates the folder. Throws InputError when that fails, or when the package or a Python with matplotlib
    /// is missing.
    explicit Figures(std::string folder);

    /// Draws all records of the file that have errors. Throws InputError when that fails; the package prints
    /// the reason to standard error.
    void draw(const std::string& records) const;

private:
    std::string folder_;
};

} // namespace tandem
