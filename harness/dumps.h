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

} // namespace tandem
