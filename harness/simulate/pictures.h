// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

/// Pictures of a recording's begin, middle and end, drawn by scripts/render with a Python.
class Pictures {
public:
    /// `out`: files are OUT-0.png, OUT-1.png and OUT-2.png; its folder is made. Throws InputError where there
    /// is no Python with numpy and Pillow, or no such folder can be made.
    explicit Pictures(std::string out);

    /// Draws and prints the paths. Throws InputError: nothing drawn; what the script says is on standard
    /// error.
    void draw(const std::string& recording) const;

private:
    std::string out_, script_, python_;
};

} // namespace tandem
