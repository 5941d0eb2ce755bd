// SPDX-License-Identifier: MIT
#include "scenes/read/read.h"

#include "base/error.h"
#include "base/files_in_use.h"
#include "scenes/read/formats.h"
#include "scenes/read/gzip.h"
#include "scenes/read/scanner.h"
#include "scenes/weld.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tandem {

namespace {

namespace fs = std::filesystem;

using Parser = Mesh (*)(std::string_view, const std::string&, const MeshReading&);

struct Format {
    std::string_view suffix;
    std::array<std::string_view, 3> openings; ///< possible first characters of the file
    Parser parse;
};

constexpr std::array formats = {
    Format{".msh", {"$MeshFormat", "$NOD", "$Comments"}, read::parse_gmsh},
    Format{".mesh", {"MeshVersionFormatted"}, read::parse_medit},
    Format{".veg", {"*VERTICES"}, read::parse_veg},
    Format{".vtk", {"# vtk"}, read::parse_vtk},
    Format{".vtu", {"<?xml", "<VTKFile", "<!--"}, read::parse_vtu},
};

std::string suffix_of(const std::string& source) {
    auto suffix = fs::path(source).extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return suffix;
}

bool opens(std::string_view text, const Format& format) {
    return std::any_of(format.openings.begin(), format.openings.end(),
                       [&](auto opening) { return !opening.empty() && text.starts_with(opening); });
}

/// The format by the file's first characters; null when they are unknown.
const Format* by_content(std::string_view bytes) {
    // The signature of legacy VTK has the syntax of a comment in the other text formats.
    if (opens(bytes, formats[3])) return &formats[3];
    read::Scanner in(bytes, "", '#');
    in.done();
    const auto found = std::find_if(formats.begin(), formats.end(), [&](const Format& format) {
        return opens(bytes.substr(in.at()), format);
    });
    return found == formats.end() ? nullptr : &*found;
}

const Format* by_suffix(const std::string& suffix) {
    const auto found =
        std::find_if(formats.begin(), formats.end(), [&](const Format& f) { return f.suffix == suffix; });
    return found == formats.end() ? nullptr : &*found;
}

/// Whether a file begins as those of Gmsh do, whose suffix Ansys Fluent has, too.
bool has_sections(std::string_view bytes) {
    read::Scanner in(bytes, "");
    return !in.done() && bytes[in.at()] == '$';
}

/// Formats without a reader, by their first characters, which have a name in refusals.
struct Foreign {
    std::string_view opening, name;
};
constexpr std::array foreign_formats = {Foreign{"MFEM mesh", "MFEM"}, Foreign{"-1", "I-deas UNV"},
                                        Foreign{"<febio_spec", "FEBio"}, Foreign{"\xff\xfe", "UTF-16"},
                                        Foreign{"\xfe\xff", "UTF-16"}};

/// The name of such a format; empty when unknown. Declarations and comments of XML may come first.
std::string_view foreign_name(std::string_view bytes) {
    read::Scanner in(bytes, "");
    in.done();
    const auto start = bytes.substr(in.at(), 2000);
    for (const auto& [opening, name] : foreign_formats)
        if (start.starts_with(opening)
            || (opening[0] == '<' && start.starts_with('<') && start.find(opening) != std::string_view::npos))
            return name;
    return {};
}

[[noreturn]] void refuse_format(std::string_view name, const std::string& source) {
    if (!name.empty())
        throw InputError(fmt::format("{}: format {} is not read; export Gmsh .msh, .vtk or .vtu, or try "
                                     "'tandem convert'",
                                     source, name));
    throw InputError(fmt::format("{}: unknown format; bring it to .vtu with 'tandem convert {} -o FILE.vtu'",
                                 source, source));
}

std::string load(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error))
        throw InputError(fmt::format("{}: is a folder; name a mesh file", path.string()));
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw InputError(fmt::format("{}: {}; check the path", path.string(), std::strerror(errno)));
    std::string bytes(static_cast<std::size_t>(std::max<std::streamoff>(file.tellg(), 0)), '\0');
    note_input(path.string());
    file.seekg(0);
    if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
        throw InputError(fmt::format("{}: cannot be read; name a regular file", path.string()));
    return read::is_gzip(bytes) ? read::gunzipped(bytes, path.string()) : bytes;
}

/// The text without a byte-order mark, which some editors put before it.
std::string_view without_mark(std::string_view bytes) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    return bytes.starts_with(mark) ? bytes.substr(mark.size()) : bytes;
}

/// A path without the suffix of gzip.
fs::path unpacked_name(const fs::path& path) {
    return path.extension() == ".gz" ? fs::path(path).replace_extension() : path;
}

/// Reads a TetGen mesh. `path` is its .node file when `is_node` is true, else its .ele file; gzip may have
/// compressed either.
Mesh read_pair(const fs::path& path, bool is_node, const MeshReading& reading) {
    auto partner = unpacked_name(path).replace_extension(is_node ? ".ele" : ".node");
    if (const auto packed = fs::path(partner.string() + ".gz"); !fs::exists(partner) && fs::exists(packed))
        partner = packed;
    const auto whole = load(path);
    if (!fs::exists(partner))
        throw InputError(fmt::format("{}: missing, the partner of {}; put both into one folder",
                                     partner.string(), path.string()));
    const auto whole_partner = load(partner);
    const auto bytes = without_mark(whole), other = without_mark(whole_partner);
    return is_node ? parse_tetgen(bytes, path.string(), other, partner.string(), reading)
                   : parse_tetgen(other, partner.string(), bytes, path.string(), reading);
}

} // namespace

void read::require_tetrahedra(const Mesh& mesh, const std::string& source) {
    if (mesh.tetrahedra.empty())
        throw InputError(fmt::format("{}: no tetrahedra; export the volume, not only the surface", source));
}

Mesh parse_mesh(std::string_view bytes, const std::string& source, const MeshReading& reading) {
    if (read::is_gzip(bytes)) return parse_mesh(read::gunzipped(bytes, source), source, reading);
    bytes = without_mark(bytes);
    if (bytes.empty()) throw InputError(fmt::format("{}: the file is empty; export it again", source));
    const auto suffix = suffix_of(unpacked_name(source).string());
    if (suffix == ".node" || suffix == ".ele")
        throw InputError(fmt::format("{}: one half of a TetGen mesh; give .node and .ele together", source));
    if (const auto name = foreign_name(bytes); !name.empty()) refuse_format(name, source);
    const Format* format = by_content(bytes);
    if (format == nullptr) format = by_suffix(suffix);
    if (format == nullptr || (format == &formats[0] && !has_sections(bytes))) refuse_format({}, source);
    Mesh mesh = format->parse(bytes, source, reading);
    read::require_tetrahedra(mesh, source);
    return mesh;
}

Mesh parse_file(const std::string& path, const MeshReading& reading) {
    const auto unpacked = unpacked_name(path);
    const auto suffix = suffix_of(unpacked.string());
    const bool pair = suffix == ".node" || suffix == ".ele";
    Mesh mesh = pair ? read_pair(path, suffix == ".node", reading) : parse_mesh(load(path), path, reading);
    mesh.name = unpacked.stem().string();
    return mesh;
}

Mesh read_mesh(const std::string& path, const MeshReading& reading) {
    auto mesh = parse_file(path, reading);
    complete_mesh(mesh, path, reading);
    mesh.findings.coincident = count_coincident(mesh);
    return mesh;
}

} // namespace tandem
