// SPDX-License-Identifier: MIT
#include "scenes/read/formats.h"
#include "scenes/read/vtk_file.h"

namespace tandem::read {

namespace {

void expect(Scanner& in, std::string_view wanted) {
    const auto word = in.token(wanted);
    if (!same_word(word, wanted))
        in.fail(fmt::format("expected {}, found {}", wanted, in_quotes(word)), "give an unstructured grid");
}

void read_header(VtkFile& file) {
    auto& in = file.in;
    if (!in.line().starts_with("# vtk DataFile Version"))
        in.fail("expected '# vtk DataFile Version'", "give a legacy VTK file");
    in.line(); // title
    const auto encoding = in.token("ASCII or BINARY");
    file.binary = same_word(encoding, "BINARY");
    if (!file.binary && !same_word(encoding, "ASCII"))
        in.fail(fmt::format("expected ASCII or BINARY, found {}", in_quotes(encoding)),
                "export the file again");
    if (file.binary) in.count_bytes();
    expect(in, "DATASET");
    expect(in, "UNSTRUCTURED_GRID");
}

/// Reads cells, each stored as its number of vertices followed by the vertices.
template<class In>
void read_rows(In& in, std::uint64_t n, std::uint64_t size, VtkFile& file) {
    in.check_count(size, 1, 4, "numbers of cells");
    if (n > size) in.fail(fmt::format("{} cells in {} numbers", n, size), "correct the counts of CELLS");
    file.cells.ends.reserve(n);
    std::uint64_t left = size;
    for (std::uint64_t i = 0; i < n; ++i) {
        const auto corners = get_whole(in, Number::i32, "the number of vertices of a cell");
        if (corners < 0 || left == 0 || static_cast<std::uint64_t>(corners) > left - 1)
            in.fail(fmt::format("a cell of {} vertices does not fit into the announced size", corners),
                    "correct the counts of CELLS");
        left -= 1 + static_cast<std::uint64_t>(corners);
        for (std::int64_t c = 0; c < corners; ++c)
            file.cells.vertices.push_back(
                check_index(in, get_whole(in, Number::i32, "a vertex number"), 0, file.mesh.vertices.size()));
        file.cells.ends.push_back(file.cells.vertices.size());
    }
    if (left > 0) in.fail(fmt::format("{} numbers are left over", left), "correct the counts of CELLS");
}

/// Reads cells of version 5: the offsets of all cells plus one, then the vertices of all cells.
void read_offsets(VtkFile& file, std::uint64_t n, std::uint64_t size) {
    auto& in = file.in;
    expect(in, "OFFSETS");
    const auto offsets = get_type(in);
    in_encoding(file, [&](auto& data) {
        if (n > 0 && get_whole(data, offsets, "an offset") != 0)
            data.fail("the first offset is not 0", "export the file again");
        if (n > 0) read_ends(data, offsets, n - 1, file.cells);
    });
    expect(in, "CONNECTIVITY");
    const auto vertices = get_type(in);
    in_encoding(file, [&](auto& data) {
        read_connectivity(data, vertices, size, file.mesh.vertices.size(), file.cells);
    });
    if (!file.cells.ends.empty() && file.cells.ends.back() != size)
        in.fail("the last offset is not the size of CONNECTIVITY", "export the file again");
}

void read_cells(VtkFile& file) {
    auto& in = file.in;
    if (!file.cells.ends.empty()) in.fail("a second section CELLS", "merge the two");
    const auto n = in.get<std::uint64_t>("the number of cells");
    const auto size = in.get<std::uint64_t>("the size of the cells");
    const auto start = in.at();
    in.line();
    const bool offsets = same_word(in.text().substr(in.at(), 7), "OFFSETS");
    in.seek(start);
    if (offsets) return read_offsets(file, n, size);
    in_encoding(file, [&](auto& data) { read_rows(data, n, size, file); });
}

void read_cell_types(VtkFile& file) {
    auto& in = file.in;
    const auto n = in.get<std::uint64_t>("the number of cell types");
    if (n != file.cells.ends.size())
        in.fail(fmt::format("{} cell types for {} cells", n, file.cells.ends.size()),
                "export the file again");
    in_encoding(file,
                [&](auto& data) { read_types(data, Number::i32, file.cells, 0, file.reading, file.mesh); });
}

} // namespace

Mesh parse_vtk(std::string_view bytes, const std::string& source, const MeshReading& reading) {
    VtkFile file{.in = Scanner(bytes, source), .reading = reading};
    auto& in = file.in;
    read_header(file);
    while (!in.done()) {
        const auto keyword = in.token("a keyword");
        if (same_word(keyword, "POINTS")) {
            const auto n = in.get<std::uint64_t>("the number of points");
            const auto type = get_type(in);
            in_encoding(file, [&](auto& data) { read_points(data, type, n, file.mesh); });
        } else if (same_word(keyword, "CELLS")) {
            read_cells(file);
        } else if (same_word(keyword, "CELL_TYPES")) {
            read_cell_types(file);
        } else if (same_word(keyword, "FIELD")) {
            skip_field(file);
        } else if (same_word(keyword, "METADATA")) {
            skip_metadata(in);
        } else if (same_word(keyword, "POINT_DATA") || same_word(keyword, "CELL_DATA")) {
            read_data(file, keyword); // they follow the grid, up to the end
            break;
        } else {
            in.fail(fmt::format("unknown keyword {}", in_quotes(keyword)),
                    "correct the counts of the section above");
        }
    }
    return std::move(file.mesh);
}

} // namespace tandem::read
