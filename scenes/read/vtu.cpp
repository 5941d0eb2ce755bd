// SPDX-License-Identifier: MIT
#include "scenes/read/formats.h"
#include "scenes/read/vtk_cells.h"
#include "scenes/read/vtu_data.h"
#include "scenes/read/xml.h"

#include <charconv>

namespace tandem::read {

namespace {

/// One part of the grid. Its vertex numbers are relative to its first point.
struct Piece {
    Tag tag = {};
    std::optional<Tag> points = {};
    std::optional<Tag> connectivity = {};
    std::optional<Tag> offsets = {};
    std::optional<Tag> types = {};
    std::optional<Tag> ghosts = {};
    std::optional<Tag> pressures = {};
};

Tag read_root(Xml& xml) {
    const auto root = xml.next();
    if (!root || root->name != "VTKFile") xml.fail(0, "expected the tag VTKFile", "give a .vtu file");
    if (root->get("type") != "UnstructuredGrid")
        xml.fail(root->at, fmt::format("VTKFile of type {} is not supported", in_quotes(root->get("type"))),
                 "give an UnstructuredGrid");
    return *root;
}

void add_array(Piece& piece, std::string_view section, const Tag& array) {
    const auto name = array.get("Name");
    if (section == "Points") piece.points = array;
    if (section == "CellData" && name == "vtkGhostType") piece.ghosts = array;
    if (section == "PointData" && name == pressure_name) piece.pressures = array;
    if (section != "Cells") return;
    if (name == "connectivity") piece.connectivity = array;
    if (name == "offsets") piece.offsets = array;
    if (name == "types") piece.types = array;
}

bool is_section(std::string_view name) {
    return name == "Points" || name == "Cells" || name == "CellData" || name == "PointData";
}

/// Collects the arrays of all pieces and finds the appended data, which come last.
std::vector<Piece> read_structure(Xml& xml, VtuData& data) {
    std::vector<Piece> pieces;
    std::string_view section;
    bool ended = false;
    while (const auto tag = xml.next()) {
        if (tag->name == "Piece") {
            pieces.push_back({*tag});
        } else if (is_section(tag->name)) {
            section = tag->closed ? "" : tag->name;
        } else if (tag->name.starts_with('/') && is_section(tag->name.substr(1))) {
            section = "";
        } else if (tag->name == "DataArray" && !pieces.empty()) {
            add_array(pieces.back(), section, *tag);
        } else if (tag->name == "AppendedData") {
            data.set_appended(*tag);
            return pieces; // the rest may not be XML
        } else if (tag->name == "/VTKFile") {
            ended = true;
        }
    }
    if (!ended)
        xml.fail(xml.text().size(), "the file ends before </VTKFile>",
                 "it is truncated: copy or export it again");
    return pieces;
}

std::uint64_t get_count(const Xml& xml, const Tag& piece, std::string_view attribute) {
    const auto text = piece.get(attribute);
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (text.empty() || error != std::errc() || end != text.data() + text.size())
        xml.fail(piece.at, fmt::format("expected a count in {}, found {}", attribute, in_quotes(text)),
                 "export the file again");
    return count;
}

template<class In>
void read_ghosts(In& in, Number type, std::uint64_t n, VtkCells& cells) {
    in.check_count(n, 1, size_of(type), "bits of vtkGhostType");
    for (std::uint64_t i = 0; i < n; ++i)
        cells.ghosts.push_back(static_cast<std::uint8_t>(get_whole(in, type, "bits of vtkGhostType")));
}

/// Reads the pressures of a piece's `points`, which follow those of `base` points of earlier pieces.
void take_pressures(const Xml& xml, const VtuData& data, const Piece& piece, std::uint64_t points,
                    std::size_t base, Mesh& mesh) {
    if (base > 0 && piece.pressures.has_value() == mesh.pressures.empty())
        xml.fail(piece.tag.at,
                 fmt::format("a Piece {} point data pressure, unlike those before it",
                             piece.pressures ? "has" : "lacks"),
                 "give it to all pieces, or to none");
    if (!piece.pressures) return;
    const auto width = piece.pressures->get("NumberOfComponents", "1");
    if (width != "1")
        xml.fail(piece.pressures->at, fmt::format("point data pressure has {} components", in_quotes(width)),
                 "give one number a point");
    data.with_array(*piece.pressures, [&](auto& in, Number type) { read_pressures(in, type, points, mesh); });
}

void read_piece(const Xml& xml, const VtuData& data, const Piece& piece, const MeshReading& reading,
                Mesh& mesh) {
    const auto points = get_count(xml, piece.tag, "NumberOfPoints");
    const auto count = get_count(xml, piece.tag, "NumberOfCells");
    if (points == 0 && count == 0) return;
    if (!piece.points || !piece.connectivity || !piece.offsets || !piece.types)
        xml.fail(piece.tag.at, "Piece lacks Points, connectivity, offsets or types", "export the file again");
    const auto base = mesh.vertices.size();
    data.with_array(*piece.points, [&](auto& in, Number type) { read_points(in, type, points, mesh); });
    take_pressures(xml, data, piece, points, base, mesh);
    if (count == 0) return;
    VtkCells cells;
    data.with_array(*piece.offsets, [&](auto& in, Number type) { read_ends(in, type, count, cells); });
    data.with_array(*piece.connectivity, [&](auto& in, Number type) {
        read_connectivity(in, type, cells.ends.back(), points, cells);
    });
    if (piece.ghosts)
        data.with_array(*piece.ghosts, [&](auto& in, Number type) { read_ghosts(in, type, count, cells); });
    data.with_array(*piece.types,
                    [&](auto& in, Number type) { read_types(in, type, cells, base, reading, mesh); });
}

} // namespace

Mesh parse_vtu(std::string_view bytes, const std::string& source, const MeshReading& reading) {
    Xml xml(bytes, source);
    VtuData data(xml, read_root(xml));
    Mesh mesh;
    for (const auto& piece : read_structure(xml, data)) read_piece(xml, data, piece, reading, mesh);
    return mesh;
}

} // namespace tandem::read
