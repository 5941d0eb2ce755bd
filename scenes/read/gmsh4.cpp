// SPDX-License-Identifier: MIT
#include "scenes/read/gmsh.h"
#include "scenes/read/vertex.h"

namespace tandem::read {

namespace {

/// Counts of a section's first line. The range of tags in this line is not used.
struct Totals {
    std::uint64_t blocks;
    std::uint64_t entities;
};

template<class In>
Totals read_totals(In& in) {
    Totals totals{};
    totals.blocks = in.template get<std::uint64_t>("the number of blocks");
    totals.entities = in.template get<std::uint64_t>("the number of entities");
    in.template get<std::uint64_t>("the smallest tag");
    in.template get<std::uint64_t>("the largest tag");
    return totals;
}

template<class In>
void check_total(const In& in, std::uint64_t sum, std::uint64_t total, std::string_view what) {
    if (sum != total)
        in.fail(fmt::format("the blocks have {} {}, the first line announces {}", sum, what, total),
                "export the file again");
}

template<class In>
void read_nodes(In& in, GmshFile& file) {
    const auto totals = read_totals(in);
    in.check_count(totals.entities, 4, 32, "nodes");
    file.tags.reserve(totals.entities);
    file.mesh.vertices.reserve(totals.entities);
    for (std::uint64_t block = 0; block < totals.blocks; ++block) {
        const auto dimension = in.template get<std::int32_t>("the dimension of an entity");
        in.template get<std::int32_t>("the tag of an entity");
        const bool parametric = in.template get<std::int32_t>("the parametric flag") != 0;
        const auto n = in.template get<std::uint64_t>("the number of nodes in a block");
        in.check_count(n, 4, 32, "nodes");
        for (std::uint64_t i = 0; i < n; ++i)
            file.tags.add(in.template get<std::uint64_t>("the tag of a node"));
        for (std::uint64_t i = 0; i < n; ++i) {
            file.mesh.vertices.push_back(get_point(in));
            // One parameter for each dimension of the entity.
            for (std::int32_t d = 0; parametric && d < dimension; ++d)
                in.template get<double>("a parametric coordinate");
        }
    }
    check_total(in, file.mesh.vertices.size(), totals.entities, "nodes");
}

template<class In>
void read_elements(In& in, GmshFile& file) {
    const auto totals = read_totals(in);
    in.check_count(totals.entities, 2, 16, "elements");
    std::uint64_t sum = 0;
    for (std::uint64_t block = 0; block < totals.blocks; ++block) {
        in.template get<std::int32_t>("the dimension of an entity");
        in.template get<std::int32_t>("the tag of an entity");
        const auto type =
            require_type(in, in.template get<std::int32_t>("the type of elements"), file.reading);
        const auto n = in.template get<std::uint64_t>("the number of elements in a block");
        const auto columns = 1 + static_cast<std::size_t>(type.nodes);
        in.check_count(n, columns, 8 * columns, "elements");
        for (std::uint64_t i = 0; i < n; ++i) {
            in.template get<std::uint64_t>("the tag of an element");
            read_corners<std::uint64_t>(in, type, file);
        }
        sum += n;
    }
    check_total(in, sum, totals.entities, "elements");
}

} // namespace

void read_nodes_41(GmshFile& file) {
    in_encoding(file, [&](auto& in) { read_nodes(in, file); });
}

void read_elements_41(GmshFile& file) {
    in_encoding(file, [&](auto& in) { read_elements(in, file); });
}

} // namespace tandem::read
