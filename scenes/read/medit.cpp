// SPDX-License-Identifier: MIT
#include "scenes/read/formats.h"
#include "scenes/read/scanner.h"
#include "scenes/read/vertex.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tandem::read {

namespace {

/// Prefixes of unsupported volume cells, including second-order tetrahedra.
constexpr std::array<std::string_view, 6> foreign = {"Tetrahedra", "Hexahedra", "Hexaedra",
                                                     "Prisms",     "Wedges",    "Pyramids"};

bool is_foreign(std::string_view keyword) {
    return std::any_of(foreign.begin(), foreign.end(), [&](auto name) { return keyword.starts_with(name); });
}

/// Nodes of a tetrahedron of order 2, 3 or 4, which has (order + 1) (order + 2) (order + 3) / 6, beside its
/// corners, which come first; 0 for other keywords.
std::size_t nodes_beside_corners(std::string_view keyword) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 3> nodes{
        {{"TetrahedraP2", 6}, {"TetrahedraP3", 16}, {"TetrahedraP4", 31}}};
    const auto found =
        std::find_if(nodes.begin(), nodes.end(), [&](auto& one) { return one.first == keyword; });
    return found == nodes.end() ? 0 : found->second;
}

/// Keywords begin with a letter; numbers do not.
bool is_keyword(std::string_view token) {
    return (token[0] >= 'A' && token[0] <= 'Z') || (token[0] >= 'a' && token[0] <= 'z');
}

/// Skips the numbers of a section.
void skip_numbers(Scanner& in) {
    while (!in.done()) {
        const auto start = in.at();
        if (!is_keyword(in.token("a number"))) continue;
        in.seek(start);
        return;
    }
}

void read_vertices(Scanner& in, Mesh& mesh) {
    const auto n = in.get<std::uint64_t>("the number of vertices");
    in.check_count(n, 4, 0, "vertices");
    mesh.vertices.reserve(n);
    for (std::uint64_t i = 0; i < n; ++i) {
        mesh.vertices.push_back(get_point(in));
        in.get<std::int64_t>("the reference of a vertex");
    }
}

/// `more`: numbers of nodes after the four corners.
void read_tetrahedra(Scanner& in, Mesh& mesh, std::size_t more) {
    if (mesh.vertices.empty())
        in.fail("Tetrahedra come before Vertices", "write Vertices first, or export the file again");
    const auto n = in.get<std::uint64_t>("the number of tetrahedra");
    in.check_count(n, 5 + more, 0, "tetrahedra");
    mesh.tetrahedra.reserve(mesh.tetrahedra.size() + n);
    if (more > 0) mesh.findings.reduced += n;
    for (std::uint64_t i = 0; i < n; ++i) {
        mesh.tetrahedra.push_back(get_tetrahedron(in, 1, mesh.vertices.size()));
        for (std::size_t node = 0; node < more; ++node) in.get<std::int64_t>("a node number");
        in.get<std::int64_t>("the reference of a tetrahedron");
    }
}

/// Skips a section, or refuses its cells.
void skip_section(Scanner& in, std::string_view keyword, const MeshReading& reading, Mesh& mesh) {
    if (is_foreign(keyword)) {
        const auto n = in.get<std::uint64_t>("a count");
        in.check_count(n, 1, 0, "cells");
        const bool is_tetrahedra = keyword.starts_with("Tetrahedra");
        if (n > 0 && (is_tetrahedra || !reading.only_tetrahedra))
            in.fail(fmt::format("cells of type {} are not linear tetrahedra", in_quotes(keyword)),
                    nodes_beside_corners(keyword) > 0 ? corners_remedy
                    : is_tetrahedra                   ? "convert to linear tetrahedra"
                                                      : only_remedy);
        mesh.findings.other_cells += n;
    }
    skip_numbers(in);
}

void read_header(Scanner& in) {
    if (const auto word = in.token("MeshVersionFormatted"); word != "MeshVersionFormatted")
        in.fail(fmt::format("expected MeshVersionFormatted, found {}", in_quotes(word)),
                "give an ASCII Medit file");
    in.get<int>("the version");
}

} // namespace

Mesh parse_medit(std::string_view bytes, const std::string& source, const MeshReading& reading) {
    Mesh mesh;
    Scanner in(bytes, source, '#');
    read_header(in);
    while (!in.done()) {
        const auto keyword = in.token("a keyword");
        if (!is_keyword(keyword))
            in.fail(fmt::format("expected a keyword, found {}", in_quotes(keyword)),
                    "correct the count of the section above");
        if (keyword == "End") break;
        if (keyword == "Dimension") {
            if (in.get<int>("the dimension") != 3) in.fail("the dimension is not 3", "give a volume mesh");
        } else if (keyword == "Vertices") {
            read_vertices(in, mesh);
        } else if (keyword == "Tetrahedra") {
            read_tetrahedra(in, mesh, 0);
        } else if (const auto more = nodes_beside_corners(keyword); more > 0 && reading.corners) {
            read_tetrahedra(in, mesh, more);
        } else {
            skip_section(in, keyword, reading, mesh);
        }
    }
    return mesh;
}

} // namespace tandem::read
