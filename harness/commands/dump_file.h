// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/parameters/row_columns.h"
#include "algorithms/traversal.h"
#include "base/whole_file.h"

#include <string>

namespace tandem {

/// A CSV file of pairs, contacts or chunks, which is there once it is complete: one without its lines would
/// read as an empty answer. The constructor makes sure, before anything is measured, that it can be written.
class DumpFile {
public:
    /// With an empty path nothing is written. Throws InputError, also for an input and a file of records,
    /// which stay as they are.
    DumpFile(const std::string& path, std::string header) : file_(path), header_(std::move(header)) {}

    /// Before the first line.
    void set_header(std::string header) { header_ = std::move(header); }
    explicit operator bool() const { return static_cast<bool>(file_); }
    /// Appends one line for each, in the given order. Coordinates are in the scene's units, as the shortest
    /// decimals that read back as the same numbers. Throws OutputError when the file cannot be written.
    void pairs(std::size_t frame, std::span<const Pair> pairs);
    /// The rows of a contact rule with these columns (row_columns()).
    void rows(std::size_t frame, std::span<const ContactPoint> contacts, std::span<const RowColumn> columns);
    /// Appends the tetrahedra of mesh `number`, in mesh coordinates. `order` maps position to tetrahedron:
    /// `leaves` successive positions form a chunk, and `leaves` successive chunks form a super chunk.
    void chunks(std::size_t number, const Mesh& mesh, std::span<const std::uint32_t> order,
                std::uint32_t leaves);
    /// Call it after the last line. Throws OutputError.
    void finish();

private:
    std::string begun();
    void write_pieces(std::string& text, std::size_t least);

    WholeFile file_;
    std::string header_; ///< empty: it is written
};

inline constexpr auto pairs_header = "frame,body_a,tet_a,body_b,tet_b\n";
inline constexpr auto chunks_header =
    "mesh,tetrahedron,position,chunk,super_chunk,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3\n";

} // namespace tandem
