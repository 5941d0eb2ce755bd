// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"
#include "scenes/read/cursor.h"
#include "scenes/read/formats.h"
#include "scenes/read/scanner.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

/// Common parts of the versions of Gmsh's MSH format.
namespace tandem::read {

/// Maps node tags, which may have gaps and any order, to indices in the order of the file.
class NodeTags {
public:
    void reserve(std::size_t n) { tags_.reserve(n); }
    void add(std::uint64_t tag);
    /// Call once after the last add. Returns a duplicate tag, or none.
    std::optional<std::uint64_t> index();
    std::optional<std::uint32_t> find(std::uint64_t tag) const;
    std::uint64_t operator[](std::size_t index) const { return tags_[index]; }
    std::size_t size() const { return tags_.size(); }

private:
    std::vector<std::uint64_t> tags_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_; ///< empty when tags are consecutive
    bool consecutive_ = true;
};

struct GmshFile {
    Scanner in;
    bool binary = false;
    Mesh mesh = {};
    NodeTags tags = {};
    MeshReading reading = {};
};

struct ElementType {
    int id;
    int dimension;
    int nodes;
    std::string_view name;
};

constexpr int gmsh_tetrahedron = 4;

/// The type with this id, or none.
std::optional<ElementType> element_type(int id);

/// Read the contents of sections $Nodes and $Elements, in version 1 $NOD and $ELM, without name and end.
void read_nodes_1(GmshFile& file);
void read_elements_1(GmshFile& file);
void read_nodes_2(GmshFile& file);
void read_elements_2(GmshFile& file);
void read_nodes_40(GmshFile& file);
void read_elements_40(GmshFile& file);
void read_nodes_41(GmshFile& file);
void read_elements_41(GmshFile& file);
/// Reads the contents of $NodeData if they are pressures. False, with nothing read, for other data.
bool read_pressures(GmshFile& file);

/// Whether elements of this type are tetrahedra of any order. Their first four nodes are the corners.
inline bool is_tetrahedron(const ElementType& type) { return type.name.ends_with("tetrahedron"); }

/// The type of elements to read (tetrahedra) or to skip. Fails for unknown types, and for those that
/// `reading` refuses.
template<class In>
ElementType require_type(const In& in, int id, const MeshReading& reading) {
    const auto type = element_type(id);
    if (!type)
        in.fail("element type " + std::to_string(id) + " is unknown",
                "convert to linear tetrahedra (type 4)");
    const bool is_accepted =
        id == gmsh_tetrahedron || (is_tetrahedron(*type) ? reading.corners : reading.only_tetrahedra);
    if (type->dimension == 3 && !is_accepted)
        in.fail("element type " + std::to_string(id) + " (" + std::string(type->name)
                    + ") is not the linear tetrahedron",
                is_tetrahedron(*type) ? corners_remedy : only_remedy);
    return *type;
}

/// Reads the nodes of one element, each of type Tag. Adds tetrahedra to the mesh.
template<class Tag, class In>
void read_corners(In& in, const ElementType& type, GmshFile& file) {
    if (!is_tetrahedron(type)) {
        for (int i = 0; i < type.nodes; ++i) in.template get<Tag>("a node tag");
        if (type.dimension == 3) ++file.mesh.findings.other_cells;
        return;
    }
    Tetrahedron corners{};
    for (auto& corner : corners) {
        const auto tag = in.template get<Tag>("a node tag");
        const auto found = file.tags.find(static_cast<std::uint64_t>(tag));
        if (!found) in.fail("node " + std::to_string(tag) + " is not in $Nodes", "repair the mesh");
        corner = *found;
    }
    for (int i = 4; i < type.nodes; ++i) in.template get<Tag>("a node tag");
    if (type.nodes > 4) ++file.mesh.findings.reduced;
    file.mesh.tetrahedra.push_back(corners);
}

/// Runs `body` on the section's text, or on its binary data, which start on the next line.
template<class Body>
void in_encoding(GmshFile& file, Body body) {
    if (!file.binary) return body(file.in);
    file.in.line();
    Cursor cursor(file.in.text(), file.in.source(), file.in.at());
    body(cursor);
    file.in.seek(cursor.at());
}

} // namespace tandem::read
