// SPDX-License-Identifier: MIT
#include "scenes/read/formats.h"
#include "scenes/read/scanner.h"
#include "scenes/read/vertex.h"

#include <optional>

namespace tandem::read {

namespace {

/// Reads the vertices and returns the number of the first.
std::int64_t read_vertices(Scanner& in, Mesh& mesh) {
    const auto n = in.get<std::uint64_t>("the number of vertices");
    in.line(); // dimension and two zeros
    in.check_count(n, 4, 0, "vertices");
    mesh.vertices.reserve(n);
    std::int64_t first = 1;
    for (std::uint64_t i = 0; i < n; ++i) {
        const auto number = in.get<std::int64_t>("the number of a vertex");
        if (i == 0) first = number;
        if (number != first + static_cast<std::int64_t>(i))
            in.fail(fmt::format("vertex {} is out of order", number), "number the vertices without gaps");
        mesh.vertices.push_back(get_point(in));
    }
    return first;
}

void read_elements(Scanner& in, std::int64_t first, Mesh& mesh) {
    if (mesh.vertices.empty()) in.fail("*ELEMENTS come before *VERTICES", "write *VERTICES first");
    const auto type = in.token("the type of the elements");
    if (type != "TET" && type != "TETS")
        in.fail(fmt::format("cells of type {} are not tetrahedra", in_quotes(type)),
                "split them into linear tetrahedra");
    const auto n = in.get<std::uint64_t>("the number of elements");
    in.line(); // vertices per element and a zero
    in.check_count(n, 5, 0, "tetrahedra");
    mesh.tetrahedra.reserve(n);
    for (std::uint64_t i = 0; i < n; ++i) {
        in.get<std::int64_t>("the number of an element");
        mesh.tetrahedra.push_back(get_tetrahedron(in, first, mesh.vertices.size()));
    }
}

} // namespace

Mesh parse_veg(std::string_view bytes, const std::string& source, const MeshReading&) {
    Mesh mesh;
    std::optional<std::size_t> include;
    std::int64_t first = 1;
    Scanner in(bytes, source, '#');
    while (!in.done()) {
        const auto word = in.token("a section");
        if (word == "*VERTICES")
            first = read_vertices(in, mesh);
        else if (word == "*ELEMENTS")
            read_elements(in, first, mesh);
        else if (word == "*INCLUDE")
            include = in.at(); // a set or a material may be in another file
        else
            in.line(); // materials, sets and regions
    }
    if (include && mesh.tetrahedra.empty()) {
        in.seek(*include);
        in.fail("*INCLUDE is not supported for vertices and elements", "put them into this file");
    }
    return mesh;
}

} // namespace tandem::read
