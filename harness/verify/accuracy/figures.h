// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Figures of records with their data, by the package python/tandem/error_figures.
class Figures {
public:
    /// Throws InputError when the package or a Python with matplotlib is missing, or the folder cannot be
    /// made.
    explicit Figures(std::string folder);

    /// Draws all records of the file that have errors. Throws InputError when that fails; standard error
    /// then says why.
    void draw(const std::string& records) const;

private:
    std::string folder_;
};

} // namespace tandem
