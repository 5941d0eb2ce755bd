// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/read/vtk_cells.h"

/// Common parts of VTK's legacy format.
namespace tandem::read {

struct VtkFile {
    Scanner in;
    bool binary = false;
    Mesh mesh = {};
    VtkCells cells = {};
    MeshReading reading = {};
};

/// Runs `body` on text, or on big-endian binary data, which start on the next line.
template<class Body>
void in_encoding(VtkFile& file, Body body) {
    if (!file.binary) return body(file.in);
    file.in.line();
    Cursor cursor(file.in.text(), file.in.source(), file.in.at(), std::endian::big);
    body(cursor);
    file.in.seek(cursor.at());
}

/// Reads the name of a number type. Fails for others than those of VTK.
Number get_type(Scanner& in);

/// Skips the arrays of FIELD, after the keyword.
void skip_field(VtkFile& file);
/// Skips METADATA, which ends with an empty line.
void skip_metadata(Scanner& in);

/// Reads the rest of the file, from the number after POINT_DATA or CELL_DATA. Keeps point data pressure only.
void read_data(VtkFile& file, std::string_view keyword);

} // namespace tandem::read
