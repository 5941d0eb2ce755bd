// SPDX-License-Identifier: MIT
#include "scenes/read/gmsh.h"
#include "scenes/read/vertex.h"

namespace tandem::read {

namespace {

template<class In>
void read_nodes(In& in, std::uint64_t n, GmshFile& file) {
    in.check_count(n, 4, 28, "nodes");
    file.tags.reserve(n);
    file.mesh.vertices.reserve(n);
    for (std::uint64_t i = 0; i < n; ++i) {
        file.tags.add(static_cast<std::uint64_t>(in.template get<std::int32_t>("the tag of a node")));
        file.mesh.vertices.push_back(get_point(in));
    }
}

template<class In>
void read_element(In& in, const ElementType& type, std::int32_t tags, GmshFile& file) {
    for (std::int32_t i = 0; i < tags; ++i) in.template get<std::int32_t>("the tag of an element");
    read_corners<std::int32_t>(in, type, file);
}

void read_elements(Scanner& in, std::uint64_t n, GmshFile& file) {
    in.check_count(n, 4, 0, "elements");
    for (std::uint64_t i = 0; i < n; ++i) {
        in.get<std::int32_t>("the number of an element");
        const auto type = require_type(in, in.get<std::int32_t>("the type of an element"), file.reading);
        read_element(in, type, in.get<std::int32_t>("the number of tags"), file);
    }
}

/// Elements are stored in runs of equal type and number of tags.
void read_elements(Cursor& in, std::uint64_t n, GmshFile& file) {
    in.check_count(n, 0, 8, "elements");
    for (std::uint64_t done = 0; done < n;) {
        const auto type = require_type(in, in.get<std::int32_t>("the type of elements"), file.reading);
        const auto run = in.get<std::int32_t>("the number of elements of a type");
        if (run < 1 || static_cast<std::uint64_t>(run) > n - done)
            in.fail(fmt::format("a run of {} elements, but {} are left", run, n - done),
                    "export the file again");
        const auto tags = in.get<std::int32_t>("the number of tags");
        for (std::int32_t i = 0; i < run; ++i) {
            in.get<std::int32_t>("the number of an element");
            read_element(in, type, tags, file);
        }
        done += static_cast<std::uint64_t>(run);
    }
}

/// Version 1: the number of nodes follows two region numbers.
void read_elements_of_1(Scanner& in, std::uint64_t n, GmshFile& file) {
    in.check_count(n, 6, 0, "elements");
    for (std::uint64_t i = 0; i < n; ++i) {
        in.get<std::int32_t>("the number of an element");
        const auto type = require_type(in, in.get<std::int32_t>("the type of an element"), file.reading);
        in.get<std::int32_t>("a physical region");
        in.get<std::int32_t>("an elementary region");
        if (in.get<std::int32_t>("the number of nodes") != type.nodes)
            in.fail(fmt::format("a {} has {} nodes", type.name, type.nodes), "export the file again");
        read_corners<std::int32_t>(in, type, file);
    }
}

} // namespace

void read_nodes_1(GmshFile& file) { read_nodes_2(file); } // the same rows, and always ASCII

void read_elements_1(GmshFile& file) {
    read_elements_of_1(file.in, file.in.get<std::uint64_t>("the number of elements"), file);
}

void read_nodes_2(GmshFile& file) {
    const auto n = file.in.get<std::uint64_t>("the number of nodes");
    in_encoding(file, [&](auto& in) { read_nodes(in, n, file); });
}

void read_elements_2(GmshFile& file) {
    const auto n = file.in.get<std::uint64_t>("the number of elements");
    in_encoding(file, [&](auto& in) { read_elements(in, n, file); });
}

} // namespace tandem::read
