// SPDX-License-Identifier: MIT
// Arrays of legacy VTK besides the grid. Only point data pressure are kept.
#include "scenes/read/vtk_file.h"

#include <algorithm>
#include <array>

namespace tandem::read {

namespace {

/// An array of numbers, bits or strings before its data.
struct Array {
    std::string_view name = {}; ///< empty: no pressures by its keyword
    std::string_view type = {};
    std::uint32_t width = 1; ///< components of a tuple
    std::uint32_t tuples = 0;
};

/// What the data of a section belong to.
struct Section {
    bool of_points = false;
    std::uint32_t tuples = 0;
};

/// Attributes of a name, a number type and a fixed number of components.
struct Attribute {
    std::string_view keyword;
    std::uint32_t width;
};
constexpr std::array attributes{Attribute{"VECTORS", 3},    Attribute{"NORMALS", 3},
                                Attribute{"TENSORS", 9},    Attribute{"TENSORS6", 6},
                                Attribute{"GLOBAL_IDS", 1}, Attribute{"PEDIGREE_IDS", 1},
                                Attribute{"EDGE_FLAGS", 1}};

Number type_named(const Scanner& in, std::string_view name) {
    const auto type = number_type(name);
    if (!type)
        in.fail(fmt::format("number type {} is not supported", in_quotes(name)),
                "save as float or double, and int");
    return *type;
}

void skip_value(Scanner& in, Number) { in.token("a value of an array"); }

void skip_value(Cursor& in, Number type) {
    for (std::size_t byte = 0; byte < size_of(type); ++byte) in.get<char>("a value of an array");
}

/// Strings in text: one on each line after the header's.
void skip_strings(Scanner& in, std::uint64_t n) {
    in.line();
    for (std::uint64_t i = 0; i < n && !in.done(); ++i) in.line();
}

/// Strings in binary data: a length, then the characters. The two highest bits of the length tell its bytes.
void skip_strings(Cursor& in, std::uint64_t n) {
    for (std::uint64_t i = 0; i < n; ++i) {
        const std::uint64_t first = in.get<std::uint8_t>("the length of a string");
        std::uint64_t length = first & 63;
        for (auto bytes = (std::uint64_t{1} << (3 - first / 64)) - 1; bytes > 0; --bytes)
            length = length << 8 | in.get<std::uint8_t>("the length of a string");
        for (; length > 0; --length) in.get<char>("a character of a string");
    }
}

/// Bits: one number each in text, eight a byte in binary data.
void skip_bits(Scanner& in, std::uint64_t n) {
    for (std::uint64_t i = 0; i < n; ++i) in.token("a value of an array");
}

void skip_bits(Cursor& in, std::uint64_t n) {
    for (std::uint64_t byte = 0; byte < (n + 7) / 8; ++byte) in.get<char>("a value of an array");
}

void skip_array(VtkFile& file, const Array& array) {
    const auto n = std::uint64_t{array.width} * array.tuples;
    if (same_word(array.type, "string")) return in_encoding(file, [&](auto& in) { skip_strings(in, n); });
    if (same_word(array.type, "bit")) return in_encoding(file, [&](auto& in) { skip_bits(in, n); });
    const auto type = type_named(file.in, array.type);
    in_encoding(file, [&](auto& in) {
        for (std::uint64_t v = 0; v < n; ++v) skip_value(in, type);
    });
}

void take_pressures(VtkFile& file, const Array& array) {
    auto& in = file.in;
    const auto points = file.mesh.vertices.size();
    if (!file.mesh.pressures.empty()) in.fail("a second array of point data pressure", "leave one out");
    if (array.width != 1 || array.tuples != points)
        in.fail(fmt::format("point data pressure has {} x {} numbers for {} points", array.tuples,
                            array.width, points),
                "give one number a point");
    const auto type = type_named(in, array.type);
    in_encoding(file, [&](auto& data) { read_pressures(data, type, points, file.mesh); });
}

/// Skips METADATA, if it follows an array.
void skip_own_metadata(Scanner& in) {
    const auto start = in.at();
    if (!in.done() && same_word(in.token("METADATA"), "METADATA")) return skip_metadata(in);
    in.seek(start);
}

void read_array(VtkFile& file, const Array& array, bool of_points) {
    if (of_points && array.name == pressure_name)
        take_pressures(file, array);
    else
        skip_array(file, array);
    skip_own_metadata(file.in);
}

/// Reads the arrays of FIELD: name, components, tuples, type, data.
void read_field(VtkFile& file, bool of_points) {
    auto& in = file.in;
    in.token("the name of a field");
    const auto arrays = in.get<std::uint64_t>("the number of arrays");
    for (std::uint64_t i = 0; i < arrays; ++i) {
        Array array;
        array.name = in.token("the name of an array");
        array.width = in.get<std::uint32_t>("the number of components");
        array.tuples = in.get<std::uint32_t>("the number of tuples");
        array.type = in.token("a number type");
        read_array(file, array, of_points);
    }
}

/// What follows the type of SCALARS: the number of components, which may be left out, and LOOKUP_TABLE NAME.
std::uint32_t read_scalars_width(Scanner& in) {
    const auto start = in.at();
    std::uint32_t width = 1;
    if (!same_word(in.token("LOOKUP_TABLE"), "LOOKUP_TABLE")) {
        in.seek(start);
        width = in.get<std::uint32_t>("the number of components or LOOKUP_TABLE");
        if (const auto word = in.token("LOOKUP_TABLE"); !same_word(word, "LOOKUP_TABLE"))
            in.fail(fmt::format("expected LOOKUP_TABLE, found {}", in_quotes(word)), "export the file again");
    }
    in.token("the name of a lookup table");
    return width;
}

/// Reads one attribute of a section, after its keyword.
void read_attribute(VtkFile& file, std::string_view keyword, const Section& section) {
    auto& in = file.in;
    if (same_word(keyword, "METADATA")) return skip_metadata(in);
    if (same_word(keyword, "FIELD")) return read_field(file, section.of_points);
    const auto is = [&](std::string_view word) { return same_word(keyword, word); };
    const auto fixed =
        std::ranges::find_if(attributes, [&](const Attribute& one) { return is(one.keyword); });
    if (fixed == attributes.end() && !is("SCALARS") && !is("TEXTURE_COORDINATES") && !is("COLOR_SCALARS")
        && !is("LOOKUP_TABLE"))
        in.fail(fmt::format("unknown keyword {}", in_quotes(keyword)),
                "correct the counts of the section above");
    Array array{.name = in.token("the name of an attribute"), .tuples = section.tuples};
    if (is("LOOKUP_TABLE")) { // of colours of four bytes
        array = {
            .type = "unsigned_char", .width = 4, .tuples = in.get<std::uint32_t>("the number of colours")};
    } else if (is("COLOR_SCALARS")) {
        const auto width = in.get<std::uint32_t>("the number of components");
        array = {.type = "unsigned_char", .width = width, .tuples = section.tuples};
    } else {
        if (is("TEXTURE_COORDINATES")) array.width = in.get<std::uint32_t>("the number of components");
        array.type = in.token("a number type");
        if (is("SCALARS")) array.width = read_scalars_width(in);
        if (fixed != attributes.end()) array.width = fixed->width;
    }
    read_array(file, array, section.of_points);
}

} // namespace

Number get_type(Scanner& in) { return type_named(in, in.token("a number type")); }

void skip_field(VtkFile& file) { read_field(file, false); }

void skip_metadata(Scanner& in) {
    in.line();
    while (!in.line().empty()) {}
}

void read_data(VtkFile& file, std::string_view keyword) {
    auto& in = file.in;
    // Other data are not even checked.
    if (in.text().find(pressure_name, in.at()) == std::string_view::npos) return;
    Section section;
    for (auto word = keyword;; word = in.token("a keyword")) {
        const bool of_points = same_word(word, "POINT_DATA");
        if (of_points || same_word(word, "CELL_DATA"))
            section = {of_points, in.get<std::uint32_t>("the number of tuples")};
        else
            read_attribute(file, word, section);
        if (in.done()) return;
    }
}

} // namespace tandem::read
