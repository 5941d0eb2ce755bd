// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/traversal.h"

#include <cstdio>
#include <memory>
#include <string>

namespace tandem {

/// A text file that is written line by line and opened before anything is measured, which throws InputError.
class DumpFile {
public:
    /// An empty path writes nowhere.
    DumpFile(const std::string& path, std::string_view header);

    explicit operator bool() const { return file_ != nullptr; }
    /// Appends a line each, in the order given. Coordinates are in the scene's units, the shortest decimals
    /// that read back as the same numbers. Throws OutputError when the file cannot take them.
    void pairs(std::size_t frame, std::span<const Pair> pairs);
    void contacts(std::size_t frame, std::span<const ContactPoint> contacts);
    /// The tetrahedra of a scene's mesh, in its own coordinates, in an order (position -> tetrahedron) of
    /// which `leaves` after one another are a chunk, and as many chunks a super chunk.
    void chunks(std::size_t number, const Mesh& mesh, std::span<const std::uint32_t> order,
                std::uint32_t leaves);

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    void write(std::string_view text) const;
    void write_pieces(std::string& text, std::size_t least) const;

    std::string path_;
    std::unique_ptr<std::FILE, Close> file_;
};

inline constexpr std::string_view pairs_header = "frame,body_a,tet_a,body_b,tet_b\n";
inline constexpr std::string_view contacts_header =
    "frame,body_a,tet_a,body_b,tet_b,px,py,pz,nx,ny,nz,depth\n";

inline constexpr std::string_view chunks_header =
    "mesh,tetrahedron,position,chunk,super_chunk,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3\n";

} // namespace tandem
