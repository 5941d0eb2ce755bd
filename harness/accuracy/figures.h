// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Figures of records with their data, by scripts/figures, which is in libexec/tandem.
class Figures {
public:
    /// Throws InputError when the script or a Python with matplotlib is missing, or the folder cannot be
    /// made.
    explicit Figures(std::string folder);

    /// Draws all records of the file that have errors. Throws InputError when the script fails, which has
    /// then said why on standard error.
    void draw(const std::string& records) const;

private:
    std::string folder_, script_, python_;
};

} // namespace tandem
