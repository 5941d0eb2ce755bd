// SPDX-License-Identifier: MIT
#include "scenes/read/formats.h"
#include "scenes/read/read.h"
#include "scenes/read/scanner.h"
#include "scenes/read/vertex.h"

namespace tandem {

namespace {

using read::Scanner;

/// The numbers of the first line; missing columns are 0.
struct Header {
    std::uint64_t count = 0;
    std::uint64_t width = 0; ///< .node: dimension; .ele: vertices per tetrahedron
    std::uint64_t attributes = 0;
    std::uint64_t markers = 0;
};

Header read_header(Scanner& in) {
    Header header;
    header.count = in.get<std::uint64_t>("the number of rows");
    const auto line = read::line_of(in.text(), in.at());
    for (auto* column : {&header.width, &header.attributes, &header.markers}) {
        if (in.done() || read::line_of(in.text(), in.at()) != line) break;
        *column = in.get<std::uint64_t>("a column count");
    }
    return header;
}

/// Rows are numbered without gaps. Another number means that the columns do not match the header.
void check_row(Scanner& in, std::uint64_t wanted) {
    if (in.get<std::uint64_t>("the number of a row") != wanted)
        in.fail(fmt::format("expected the row with number {}", wanted),
                "number the rows without gaps, and match the columns with the first line");
}

void skip_columns(Scanner& in, std::uint64_t n) {
    for (std::uint64_t i = 0; i < n; ++i) in.token("an attribute or marker");
}

/// Reads the vertices and returns the number of the first: 0 or 1.
std::uint64_t read_nodes(Scanner& in, Mesh& mesh) {
    const auto header = read_header(in);
    if (header.width != 3) in.fail("the dimension is not 3", "give a volume mesh");
    in.check_count(header.count, 4, 0, "vertices");
    mesh.vertices.reserve(header.count);
    std::uint64_t first = 0;
    for (std::uint64_t i = 0; i < header.count; ++i) {
        if (i == 0) {
            first = in.get<std::uint64_t>("the number of a row");
            if (first > 1) in.fail("the first vertex is neither 0 nor 1", "number the vertices from 0 or 1");
        } else {
            check_row(in, first + i);
        }
        mesh.vertices.push_back(read::get_point(in));
        skip_columns(in, header.attributes);
        skip_columns(in, header.markers);
    }
    return first;
}

void read_elements(Scanner& in, std::uint64_t first, const MeshReading& reading, Mesh& mesh) {
    const auto header = read_header(in);
    const bool is_second_order = header.width == 10;
    if (is_second_order && !reading.corners)
        in.fail("cells of type second-order tetrahedron (10 vertices)", read::corners_remedy);
    if (header.width != 4 && !is_second_order)
        in.fail(fmt::format("cells of {} vertices are not tetrahedra", header.width),
                "give 4 vertices a cell");
    in.check_count(header.count, 5, 0, "tetrahedra");
    mesh.tetrahedra.reserve(header.count);
    for (std::uint64_t i = 0; i < header.count; ++i) {
        check_row(in, first + i);
        mesh.tetrahedra.push_back(
            read::get_tetrahedron(in, static_cast<std::int64_t>(first), mesh.vertices.size()));
        skip_columns(in, header.width - 4);
        skip_columns(in, header.attributes);
    }
    if (is_second_order) mesh.findings.reduced = header.count;
}

void check_end(Scanner& in) {
    if (!in.done())
        in.fail(fmt::format("more rows than the first line announces, found {}",
                            read::in_quotes(in.token("a row"))),
                "correct the count");
}

} // namespace

Mesh parse_tetgen(std::string_view node, const std::string& node_source, std::string_view ele,
                  const std::string& ele_source, const MeshReading& reading) {
    Mesh mesh;
    Scanner nodes(node, node_source, '#');
    const auto first = read_nodes(nodes, mesh);
    check_end(nodes);
    Scanner elements(ele, ele_source, '#');
    read_elements(elements, first, reading, mesh);
    check_end(elements);
    read::require_tetrahedra(mesh, ele_source);
    return mesh;
}

} // namespace tandem
