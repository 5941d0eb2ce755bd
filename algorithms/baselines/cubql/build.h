// SPDX-License-Identifier: MIT
// Between the project and the files that CUDA's compiler compiles; plain types only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace tandem::cubql_trees {

/// A box; the layout of cuBQL's box3f.
struct Box {
    std::array<float, 3> lower, upper;
};

/// A node of cuBQL's binary tree. Two children follow each other. `admin`: the index of the first child, or
/// the first tetrahedron of a leaf in `order`; above them, in 16 bits, the number of the leaf's tetrahedra.
struct Node {
    Box box;
    std::uint64_t admin;
};
static_assert(sizeof(Node) == 32);

/// A row of the table of trees, one per body: first rows of its nodes, of its mesh's order and of its boxes,
/// and its number of tetrahedra.
struct TreeRow {
    std::uint32_t first_node = 0, first_of_order = 0, first_box = 0, count = 0;
};

/// Inner nodes have no tetrahedra of their own.
inline std::uint32_t tetrahedra_of(const Node& node) { return static_cast<std::uint32_t>(node.admin >> 48); }
/// The first child of an inner node.
inline std::uint32_t first_child(const Node& node) {
    return static_cast<std::uint32_t>(node.admin & 0xffffffffffffu);
}

/// The tree of a mesh, in host memory.
struct Tree {
    std::vector<Node> nodes;          ///< node 0 is the root; node 1 is not used
    std::vector<std::uint32_t> order; ///< indices of boxes, leaf by leaf
};

/// Builds a tree with cuBQL's builder for the surface area heuristic on CUDA device `device`; a leaf has at
/// most `leaf_size` boxes. Throws std::runtime_error with CUDA's message.
Tree build(int device, const std::vector<Box>& boxes, int leaf_size);

/// PTX of query.cu, made when the project was built; empty in a program without cuBQL.
extern const char* const query_ptx;

} // namespace tandem::cubql_trees
