// SPDX-License-Identifier: MIT
#pragma once

#include "harness/passing_folder.h"

#include <string>

namespace tandem {

/// Tables, figures, verdicts and the page of a folder of `tandem paper`, made from its records by the Python
/// package, which is part of the program.
class PaperDrawing {
public:
    /// Throws InputError where there is no Python with what it takes, or no room
    /// for the package.
    PaperDrawing();

    /// Whether all of it was made; it prints a line of what it made, or why not.
    bool draw(const std::string& folder) const;

private:
    std::string python_;
    PassingFolder package_;
};

} // namespace tandem
