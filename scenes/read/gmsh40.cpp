// SPDX-License-Identifier: MIT
// MSH 4.0, which Gmsh 4.0 writes as version 4: like 4.1, but blocks begin with the tag of an entity, tags are
// 32-bit, and each node has its tag beside its coordinates.
#include "scenes/read/gmsh.h"
#include "scenes/read/vertex.h"

namespace tandem::read {

namespace {

/// Reads blocks until they have all `total` entities. block(in) reads one and returns its number of entities.
template<class In, class Block>
void read_blocks(In& in, std::string_view what, std::uint64_t blocks, std::uint64_t total, Block block) {
    std::uint64_t sum = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) sum += block();
    if (sum != total)
        in.fail(fmt::format("the blocks have {} {}, the first line announces {}", sum, what, total),
                "export the file again");
}

template<class In>
std::uint64_t read_node_block(In& in, GmshFile& file) {
    in.template get<std::int32_t>("the tag of an entity");
    const auto dimension = in.template get<std::int32_t>("the dimension of an entity");
    const bool is_parametric = in.template get<std::int32_t>("the parametric flag") != 0;
    const auto n = in.template get<std::uint64_t>("the number of nodes in a block");
    in.check_count(n, 4, 28, "nodes");
    for (std::uint64_t i = 0; i < n; ++i) {
        file.tags.add(static_cast<std::uint64_t>(in.template get<std::int32_t>("the tag of a node")));
        file.mesh.vertices.push_back(get_point(in));
        for (std::int32_t d = 0; is_parametric && d < dimension; ++d)
            in.template get<double>("a parametric coordinate");
    }
    return n;
}

template<class In>
std::uint64_t read_element_block(In& in, GmshFile& file) {
    in.template get<std::int32_t>("the tag of an entity");
    in.template get<std::int32_t>("the dimension of an entity");
    const auto type = require_type(in, in.template get<std::int32_t>("the type of elements"), file.reading);
    const auto n = in.template get<std::uint64_t>("the number of elements in a block");
    const auto columns = 1 + static_cast<std::size_t>(type.nodes);
    in.check_count(n, columns, 4 * columns, "elements");
    for (std::uint64_t i = 0; i < n; ++i) {
        in.template get<std::int32_t>("the tag of an element");
        read_corners<std::int32_t>(in, type, file);
    }
    return n;
}

} // namespace

void read_nodes_40(GmshFile& file) {
    in_encoding(file, [&](auto& in) {
        const auto blocks = in.template get<std::uint64_t>("the number of blocks");
        const auto total = in.template get<std::uint64_t>("the number of nodes");
        in.check_count(total, 4, 28, "nodes");
        file.tags.reserve(total);
        file.mesh.vertices.reserve(total);
        read_blocks(in, "nodes", blocks, total, [&] { return read_node_block(in, file); });
    });
}

void read_elements_40(GmshFile& file) {
    in_encoding(file, [&](auto& in) {
        const auto blocks = in.template get<std::uint64_t>("the number of blocks");
        const auto total = in.template get<std::uint64_t>("the number of elements");
        in.check_count(total, 2, 8, "elements");
        read_blocks(in, "elements", blocks, total, [&] { return read_element_block(in, file); });
    });
}

} // namespace tandem::read
