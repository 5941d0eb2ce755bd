// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh_reading.h"

#include <string>

namespace tandem {

/// Pictures of the first, middle and last frame of a recording. The Python script scripts/render draws them.
class Pictures {
public:
    /// The files are OUT-0.png, OUT-1.png and OUT-2.png; their folder is made. Throws InputError when there
    /// is no Python with numpy and Pillow, or the folder cannot be made.
    explicit Pictures(std::string out);

    /// Draws the pictures and prints their paths. `reading`: how the recorded scene was read. Throws
    /// InputError when the script fails; its messages are on standard error.
    void draw(const std::string& recording, const MeshReading& reading) const;

private:
    std::string out_, script_, python_;
};

} // namespace tandem
