// SPDX-License-Identifier: MIT
// $NodeData, which is the same in all versions: tags of text, tags of reals and tags of integers, each after
// their number, then the tag of a node and its values for each node. In binary files the last part is binary.
#include "scenes/read/gmsh.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::read {

namespace {

/// The text of a line without blanks and quotes around it.
std::string_view unquoted(std::string_view line) {
    constexpr std::string_view around = " \t\"";
    const auto first = std::min(line.find_first_not_of(around), line.size());
    return line.substr(first, line.find_last_not_of(around) + 1 - first);
}

/// Whether the first tag of text, which names the data, is that of pressures. If so, moves behind all of
/// them.
bool read_name(Scanner& in) {
    const auto start = in.at();
    const auto count = in.get<std::uint32_t>("the number of tags of text");
    in.line();
    for (std::uint32_t i = 0; i < count && !in.done(); ++i)
        if (const auto text = unquoted(in.line()); i == 0 && text != pressure_name) {
            in.seek(start);
            return false;
        }
    return count > 0;
}

/// The number of values, by the tags of integers: time step, components, values.
std::uint64_t read_count(Scanner& in) {
    for (auto reals = in.get<std::uint32_t>("the number of real tags"); reals > 0; --reals)
        in.token("a real tag");
    const auto integers = in.get<std::uint32_t>("the number of integer tags");
    if (integers < 3) in.fail(fmt::format("{} integer tags instead of 3", integers), "export the file again");
    in.token("the time step");
    if (const auto width = in.get<std::int32_t>("the number of components"); width != 1)
        in.fail(fmt::format("$NodeData pressure has {} components", width), "give one number a node");
    const auto count = in.get<std::uint64_t>("the number of values");
    for (std::uint32_t i = 3; i < integers; ++i) in.token("an integer tag");
    return count;
}

template<class In>
void read_values(In& in, std::uint64_t n, GmshFile& file) {
    const auto nodes = file.tags.size();
    in.check_count(n, 2, 12, "pressures");
    file.mesh.pressures.resize(nodes);
    std::vector<bool> is_known(nodes);
    for (std::uint64_t i = 0; i < n; ++i) {
        const auto tag = in.template get<std::int32_t>("the tag of a node");
        const auto node = file.tags.find(static_cast<std::uint64_t>(tag));
        if (!node) in.fail(fmt::format("node {} is not in $Nodes", tag), "repair the file");
        if (is_known[*node]) in.fail(fmt::format("node {} has two pressures", tag), "give each node one");
        is_known[*node] = true;
        file.mesh.pressures[*node] = in.template get<double>("a pressure");
    }
    const auto missing = std::find(is_known.begin(), is_known.end(), false) - is_known.begin();
    if (n < nodes)
        in.fail(fmt::format("$NodeData pressure leaves out {} of {} nodes, such as node {}", nodes - n, nodes,
                            file.tags[static_cast<std::size_t>(missing)]),
                "give every node a pressure");
}

} // namespace

bool read_pressures(GmshFile& file) {
    auto& in = file.in;
    if (!read_name(in)) return false;
    if (file.tags.size() == 0) in.fail("$NodeData comes before $Nodes", "export the file again");
    if (!file.mesh.pressures.empty()) in.fail("a second $NodeData pressure", "keep one time step");
    const auto n = read_count(in);
    in_encoding(file, [&](auto& data) { read_values(data, n, file); });
    return true;
}

} // namespace tandem::read
