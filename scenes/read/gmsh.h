// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/mesh.h"
#include "scenes/read/cursor.h"
#include "scenes/read/scanner.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

/// Common parts of the two versions of Gmsh's MSH format.
namespace tandem::read {

/// Maps node tags, which may have gaps and any order, to indices in the order of the file.
class NodeTags {
public:
    void reserve(std::size_t n) { tags_.reserve(n); }
    void add(std::uint64_t tag);
    /// Call once after the last add. Returns a duplicate tag, or none.
    std::optional<std::uint64_t> index();
    std::optional<std::uint32_t> find(std::uint64_t tag) const;
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

/// Read the contents of sections $Nodes and $Elements, without name and end.
void read_nodes_2(GmshFile& file);
void read_elements_2(GmshFile& file);
void read_nodes_4(GmshFile& file);
void read_elements_4(GmshFile& file);

/// The type of elements to read (tetrahedra) or to skip (lower dimension). Fails for all other types.
template<class In>
ElementType require_type(const In& in, int id) {
    const auto type = element_type(id);
    if (!type)
        in.fail("element type " + std::to_string(id) + " is unknown",
                "convert to linear tetrahedra (type 4)");
    if (type->dimension == 3 && id != gmsh_tetrahedron)
        in.fail("element type " + std::to_string(id) + " (" + std::string(type->name)
                    + ") is not the linear tetrahedron",
                "mesh with linear tetrahedra only (type 4)");
    return *type;
}

/// Reads the nodes of one element, each of type Tag. Adds tetrahedra to the mesh.
template<class Tag, class In>
void read_corners(In& in, const ElementType& type, const NodeTags& tags, Mesh& mesh) {
    if (type.id != gmsh_tetrahedron) {
        for (int i = 0; i < type.nodes; ++i) in.template get<Tag>("a node tag");
        return;
    }
    Tetrahedron corners{};
    for (auto& corner : corners) {
        const auto tag = in.template get<Tag>("a node tag");
        const auto found = tags.find(static_cast<std::uint64_t>(tag));
        if (!found) in.fail("node " + std::to_string(tag) + " is not in $Nodes", "repair the mesh");
        corner = *found;
    }
    mesh.tetrahedra.push_back(corners);
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
