// SPDX-License-Identifier: MIT
#include "scenes/read/gmsh.h"

#include "scenes/read/formats.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::read {

namespace {

/// What reads the contents of sections of a version, without name and end.
struct Version {
    void (*read_nodes)(GmshFile&);
    void (*read_elements)(GmshFile&);
};
constexpr Version version_1{read_nodes_1, read_elements_1};
constexpr Version version_2{read_nodes_2, read_elements_2};
constexpr Version version_40{read_nodes_40, read_elements_40};
constexpr Version version_41{read_nodes_41, read_elements_41};

/// The version by its number in $MeshFormat. Gmsh writes version 4.0 as 4.
const Version& version_named(Scanner& in) {
    const auto number = in.token("the MSH version");
    if (number == "2.2" || number == "2.1" || number == "2" || number == "2.0") return version_2;
    if (number == "4" || number == "4.0") return version_40;
    if (number != "4.1")
        in.fail(fmt::format("MSH version {} is not supported", in_quotes(number)),
                "bring it to .vtu with 'tandem convert', or save as MSH 2.2 or 4.1");
    return version_41;
}

/// Reads $MeshFormat up to its end.
const Version& read_version(GmshFile& file) {
    auto& in = file.in;
    const auto& version = version_named(in);
    const int encoding = in.get<int>("the file type");
    if (encoding != 0 && encoding != 1)
        in.fail("the file type is neither 0 (ASCII) nor 1 (binary)", "export the file again");
    if (in.get<int>("the data size") != 8) in.fail("the data size is not 8", "save with doubles");
    if (encoding == 0) return version;
    file.binary = true;
    in.count_bytes();
    in.line();
    Cursor cursor(in.text(), in.source(), in.at());
    if (cursor.get<std::int32_t>("the byte-order mark") != 1)
        cursor.fail("the byte-order mark is not 1: the file is big endian",
                    "save on a little-endian machine");
    in.seek(cursor.at());
    return version;
}

/// Searches for the section's end, since its content can be binary.
void skip_section(Scanner& in, std::string_view name) {
    const auto end = in.text().find(fmt::format("$End{}", name.substr(1)), in.at());
    if (end == std::string_view::npos)
        in.fail(fmt::format("section {} has no end", in_quotes(name)),
                "the file is truncated: copy or export it again");
    in.seek(end);
}

/// The end of a section: $EndNodes, in version 1 $ENDNOD.
std::string end_of(std::string_view name) {
    const bool is_version_1 = name == "$NOD" || name == "$ELM";
    return fmt::format("${}{}", is_version_1 ? "END" : "End", name.substr(1));
}

/// Reads the end of a section. Numbers in its place mean that the section's count is too small.
void end_section(Scanner& in, std::string_view name) {
    const auto wanted = end_of(name);
    if (in.done() || in.text()[in.at()] == '$') {
        const auto start = in.at();
        if (in.done() || in.token(wanted) != wanted)
            in.fail(fmt::format("{} is missing", wanted), "copy or export the file again");
        in.seek(start);
    }
    const auto word = in.token(wanted);
    if (word != wanted)
        in.fail(fmt::format("expected {}, found {}", in_quotes(wanted), in_quotes(word)),
                "correct the count of the section");
}

std::string_view section_name(Scanner& in) {
    const auto name = in.token("a section");
    if (name == "$ParametricNodes")
        in.fail("section $ParametricNodes is not supported",
                "save without Mesh.SaveParametric, or as MSH 4.1");
    if (name[0] != '$' || name.size() < 2)
        in.fail(fmt::format("expected a section such as $Nodes, found {}", in_quotes(name)),
                "correct the file or export it again");
    return name;
}

void read_nodes(GmshFile& file, const Version& version) {
    if (file.tags.size() > 0) file.in.fail("a second section $Nodes", "merge the two");
    version.read_nodes(file);
    if (const auto duplicate = file.tags.index())
        file.in.fail(fmt::format("node {} occurs twice", *duplicate), "repair the mesh");
}

} // namespace

Mesh parse_gmsh(std::string_view bytes, const std::string& source, const MeshReading& reading) {
    GmshFile file{.in = Scanner(bytes, source), .reading = reading};
    const Version* version = nullptr;
    while (!file.in.done()) {
        const auto name = section_name(file.in);
        const bool is_1 = name == "$NOD" || name == "$ELM";
        const bool nodes = name == "$Nodes" || name == "$NOD",
                   elements = name == "$Elements" || name == "$ELM";
        if (is_1 && version == nullptr) version = &version_1;
        if ((nodes || elements) && (version == nullptr || is_1 != (version == &version_1)))
            file.in.fail(fmt::format("{} comes before $MeshFormat", name), "export the file again");
        if (name == "$MeshFormat")
            version = &read_version(file);
        else if (nodes)
            read_nodes(file, *version);
        else if (elements)
            version->read_elements(file);
        else if (name != "$NodeData" || !read_pressures(file))
            skip_section(file.in, name);
        end_section(file.in, name);
    }
    return std::move(file.mesh);
}

} // namespace tandem::read
