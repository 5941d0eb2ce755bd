// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Figures of records with their data: scripts/figures, whose text the program holds, run by a Python that
/// has matplotlib.
class Figures {
public:
    /// Throws InputError when there is no such Python or the folder cannot be made.
    explicit Figures(std::string folder);

    /// Draws all records of the file that have errors. Throws InputError when the script fails, which has
    /// then said why on standard error.
    void draw(const std::string& records) const;

private:
    std::string folder_, python_;
};

} // namespace tandem
