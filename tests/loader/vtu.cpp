// SPDX-License-Identifier: MIT
#include "tests/loader/files.h"
#include "tests/support/test.h"
#include "scenes/mesh.h"

#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

namespace tandem::loader {
namespace {

std::string base64(std::string_view bytes) {
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t b = 0; b < 3; ++b)
            group = group << 8 | (i + b < bytes.size() ? static_cast<unsigned char>(bytes[i + b]) : 0u);
        for (std::size_t d = 0; d < 4; ++d)
            text += i + d > bytes.size() ? '=' : digits[group >> (18 - 6 * d) & 63];
    }
    return text;
}

/// Storage of the arrays in a file.
struct Encoding {
    enum { ascii, inlined, appended, raw } format = inlined;
    bool compressed = false;
    bool wide = false;     ///< 64-bit headers, Float64 and Int64; otherwise 32 bits, Float32 and Int32
    bool big = false;      ///< big-endian
    std::size_t part = 24; ///< bytes per compressed block
    enum { zlib, lz4, lzma } packer = zlib;
};

template<class T>
std::string number(T value, const Encoding& how) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (how.big) std::reverse(raw.begin(), raw.end());
    return raw;
}

std::string header(std::uint64_t value, const Encoding& how) {
    return how.wide ? number(value, how) : number(static_cast<std::uint32_t>(value), how);
}

std::string packed(const std::string& part, const Encoding& how) {
    std::string bytes(2 * compressBound(part.size()) + 1024, '\0'); // enough for all of them
    if (how.packer == Encoding::lz4) {
        const auto size = LZ4_compress_default(part.data(), bytes.data(), static_cast<int>(part.size()),
                                               static_cast<int>(bytes.size()));
        return bytes.substr(0, static_cast<std::size_t>(size));
    }
    if (how.packer == Encoding::lzma) {
        std::size_t size = 0;
        lzma_easy_buffer_encode(6, LZMA_CHECK_CRC32, nullptr,
                                reinterpret_cast<const std::uint8_t*>(part.data()), part.size(),
                                reinterpret_cast<std::uint8_t*>(bytes.data()), &size, bytes.size());
        return bytes.substr(0, size);
    }
    uLongf size = bytes.size();
    compress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
             part.size());
    return bytes.substr(0, size);
}

std::string block(const std::string& data, const Encoding& how) {
    const bool text = how.format != Encoding::raw;
    if (!how.compressed) {
        const auto whole = header(data.size(), how) + data;
        return text ? base64(whole) : whole;
    }
    std::string sizes, parts;
    std::size_t count = 0;
    for (std::size_t at = 0; at < data.size(); at += how.part, ++count) {
        const auto one = packed(data.substr(at, how.part), how);
        parts += one;
        sizes += header(one.size(), how);
    }
    const auto head =
        header(count, how) + header(how.part, how) + header(data.size() % how.part, how) + sizes;
    return text ? base64(head) + base64(parts) : head + parts; // the header is encoded separately
}

/// The example with a triangle before its tetrahedra; callers may change the values.
struct Example {
    std::vector<double> points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1.5, -0.25, 2, 0.125, 0.1, 0.2, -3e-7};
    std::vector<std::int64_t> connectivity = {0, 1, 2, 0, 1, 2, 3, 4, 3, 2, 1};
    std::vector<std::int64_t> offsets = {3, 7, 11};
    std::vector<std::int64_t> types = {5, 10, 10};
    std::vector<double> pressures = {}; ///< empty: no such array
    std::string appended = {};

    template<class Values>
    std::string array(const std::string& attributes, const std::string& type, const Values& values,
                      const Encoding& how) {
        const auto open = "<DataArray type=\"" + type + "\" " + attributes + " format=\"";
        std::string data, text;
        for (const auto value : values) {
            text += std::to_string(value) + " ";
            if (type == "UInt8") data += number(static_cast<std::uint8_t>(value), how);
            if (type == "Int32") data += number(static_cast<std::int32_t>(value), how);
            if (type == "Int64") data += number(static_cast<std::int64_t>(value), how);
            if (type == "Float32") data += number(static_cast<float>(value), how);
            if (type == "Float64") data += number(static_cast<double>(value), how);
        }
        if (how.format == Encoding::ascii) return open + "ascii\">\n" + text + "\n</DataArray>\n";
        if (how.format == Encoding::inlined)
            return open + "binary\">\n" + block(data, how) + "\n</DataArray>\n";
        const auto offset = std::to_string(appended.size());
        appended += block(data, how);
        return open + "appended\" offset=\"" + offset + "\"/>\n";
    }

    std::string file(const Encoding& how) {
        const std::string real = how.wide ? "Float64" : "Float32", whole = how.wide ? "Int64" : "Int32";
        std::string text =
            "<?xml version=\"1.0\"?>\n<!-- <Piece> -->\n<VTKFile type=\"UnstructuredGrid\" byte_order=\"";
        text += how.big ? "BigEndian" : "LittleEndian";
        text += how.wide ? "\" header_type=\"UInt64\"" : "\"";
        const std::string compressors[] = {"ZLib", "LZ4", "LZMA"};
        text +=
            how.compressed ? " compressor=\"vtk" + compressors[how.packer] + "DataCompressor\">\n" : ">\n";
        text += "<UnstructuredGrid>\n<Piece NumberOfPoints=\"6\" NumberOfCells=\"3\">\n<PointData>\n";
        text += "<DataArray type=\"Float32\" Name=\"s\" "
                "format=\"ascii\">nan</DataArray>\n";
        if (!pressures.empty()) text += array("Name=\"pressure\"", real, pressures, how);
        text += "</PointData>\n<Points>\n";
        text += array("Name=\"Points\" NumberOfComponents=\"3\"", real, points, how) + "</Points>\n<Cells>\n";
        text += array("Name=\"connectivity\"", whole, connectivity, how);
        text += array("Name=\"offsets\"", whole, offsets, how);
        text += array("Name=\"types\"", "UInt8", types, how) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
        if (how.format == Encoding::appended)
            text += "<AppendedData encoding=\"base64\">\n_" + appended + "\n";
        if (how.format == Encoding::raw) text += "<AppendedData encoding=\"raw\">\n_" + appended + "\n";
        if (!appended.empty()) text += "</AppendedData>\n";
        return text + "</VTKFile>\n";
    }
};

/// Text with all digits: std::to_string keeps only six.
std::string ascii() {
    auto text = Example().file({.format = Encoding::ascii, .wide = true});
    return replaced(text, "-0.000000", "-3e-7");
}

TEST(Vtu, OtherCompressors) {
    for (const auto packer : {Encoding::lz4, Encoding::lzma}) {
        const auto text = Example().file({.format = Encoding::inlined, .compressed = true, .packer = packer});
        expect_example(read_mesh(write_file("packed.vtu", text)), true);
        const auto other = packer == Encoding::lz4 ? "vtkLZMAData" : "vtkLZ4Data";
        expect_failure("other.vtu",
                       replaced(text, packer == Encoding::lz4 ? "vtkLZ4Data" : "vtkLZMAData", other), ":",
                       "");
    }
}

/// Bits 1 and 32 of vtkGhostType leave a cell out, others do not.
TEST(Vtu, GhostCells) {
    const auto with = [](const std::string& bits) {
        const auto data = "<CellData>\n<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">"
                          + bits + "</DataArray>\n</CellData>\n<Points>";
        return write_file("ghosts.vtu", replaced(ascii(), "<Points>", data));
    };
    expect_example(read_mesh(with("1 0 4")), false);
    for (const auto* bits : {"0 0 1", "0 0 32", "0 2 33"}) {
        const auto mesh = read_mesh(with(bits));
        EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}})) << bits;
        EXPECT_EQ(mesh.findings.ghosts, 1u);
    }
}

TEST(Vtu, AngleInQuotes) {
    expect_example(read_mesh(write_file("quoted.vtu", replaced(ascii(), "Name=\"s\"", "Name=\"a > 'b'\""))),
                   false);
}

TEST(Vtu, Ascii) { expect_example(read_mesh(write_file("ascii.vtu", ascii())), false); }

TEST(Vtu, EveryEncoding) {
    for (const auto format : {Encoding::inlined, Encoding::appended, Encoding::raw})
        for (const int bits : {0, 1, 2, 3, 4, 5, 6, 7}) {
            SCOPED_TRACE(std::to_string(format) + " " + std::to_string(bits));
            const Encoding how{format, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
            expect_example(read_mesh(write_file("two.vtu", Example().file(how))), !how.wide);
        }
}

TEST(Vtu, PiecesAppend) {
    const auto one = ascii();
    const auto start = one.find("<Piece Number"), end = one.find("</UnstructuredGrid>");
    const auto mesh = read_mesh(write_file("pieces.vtu", one.substr(0, end) + one.substr(start)));
    EXPECT_EQ(mesh.vertices.size(), 12u);
    EXPECT_EQ(mesh.tetrahedra.size(), 4u);
    EXPECT_EQ(mesh.tetrahedra.back(), (Tetrahedron{10, 9, 8, 7}));
}

const std::vector<double> example_pressures{0, 0.5, 1.25, 0, 3e7, 0.125};

TEST(Vtu, Pressures) {
    for (const auto format : {Encoding::ascii, Encoding::inlined, Encoding::appended, Encoding::raw})
        for (const int bits : {0, 1, 2, 3, 4, 5, 6, 7}) {
            SCOPED_TRACE(std::to_string(format) + " " + std::to_string(bits));
            const Encoding how{format, (bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
            Example given{.pressures = example_pressures};
            if (format == Encoding::ascii) given.points[17] = 0; // std::to_string keeps six digits
            auto mesh = read_mesh(write_file("pressures.vtu", given.file(how)));
            if (format == Encoding::ascii) mesh.vertices[5].z() = -3e-7;
            expect_example(mesh, format != Encoding::ascii && !how.wide);
            EXPECT_EQ(mesh.pressures, example_pressures);
        }
}

/// An array of that name in other places, and of another name, is no pressure.
TEST(Vtu, OtherArraysAreNoPressures) {
    for (const auto* place : {"<CellData>", "<FieldData>", "<PointData/><FieldData>"}) {
        const auto section = std::string(place).substr(std::string(place).rfind('<') + 1);
        const auto array = "<DataArray type=\"Float32\" Name=\"pressure\" format=\"ascii\">1 2 3</DataArray>";
        const auto text =
            replaced(ascii(), "<Points>", std::string(place) + array + "</" + section + "<Points>");
        EXPECT_TRUE(read_mesh(write_file("elsewhere.vtu", text)).pressures.empty()) << place;
    }
}

TEST(Vtu, BadPressures) {
    const auto text = [](const std::string& array, const std::string& attributes = "") {
        return replaced(ascii(), "</PointData>",
                        "<DataArray type=\"Float64\" Name=\"pressure\" " + attributes + " format=\"ascii\">"
                            + array + "</DataArray>\n</PointData>");
    };
    const std::string one = "NumberOfComponents=\"1\"", three = "NumberOfComponents=\"3\"";
    EXPECT_EQ(read_mesh(write_file("one.vtu", text("0 1 2 3 4 5", one))).pressures.size(), 6u);
    expect_failure("three.vtu", text("0 1 2 3 4 5", three), ":8", "pressure has '3' components");
    expect_failure("few.vtu", text("0 1 2 3 4"), ":8", "6 pressures announced");
    expect_failure("many.vtu", text("0 1 2 3 4 5 6"), ":8", "more numbers than announced");
    expect_failure("nan.vtu", text("0 1 2 3 nan 5"), ":8", "a pressure 'nan' is not finite");
    expect_failure("negative.vtu", text("0 1 2 3 -4 5"), ": ", "the pressure of vertex 4 is -4");
    Example infinite{.pressures = example_pressures};
    infinite.pressures[4] = std::numeric_limits<double>::infinity();
    expect_failure("infinite.vtu", infinite.file({.wide = true}), ":8: DataArray 'pressure': byte 32",
                   "a pressure is not finite");
}

TEST(Vtu, AllPiecesHavePressuresOrNone) {
    const auto with = Example{.pressures = example_pressures}.file({}), without = Example().file({});
    const auto pieces = [](const std::string& first, const std::string& second) {
        const auto start = second.find("<Piece Number"), end = first.find("</UnstructuredGrid>");
        return first.substr(0, end) + second.substr(start);
    };
    auto twice = example_pressures;
    twice.insert(twice.end(), example_pressures.begin(), example_pressures.end());
    EXPECT_EQ(read_mesh(write_file("both.vtu", pieces(with, with))).pressures, twice);
    const std::string empty = "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"></Piece>\n</UnstructuredGrid>";
    EXPECT_EQ(read_mesh(write_file("empty.vtu", replaced(with, "</UnstructuredGrid>", empty))).pressures,
              example_pressures);
    expect_failure("first.vtu", pieces(with, without), ":29", "a Piece lacks point data pressure");
    expect_failure("second.vtu", pieces(without, with), ":26", "a Piece has point data pressure");
}

TEST(Vtu, OtherCells) {
    Example second;
    second.types[2] = 24;
    const std::string reason = "cells of type 24 (quadratic tetrahedron)";
    expect_failure("text.vtu", second.file({.format = Encoding::ascii}), ":22", reason);
    expect_failure("binary.vtu", second.file({}), ":21: DataArray 'types': byte 2", reason);
}

TEST(Vtu, BadNumbers) {
    Example index;
    index.connectivity[10] = 6;
    expect_failure("index.vtu", index.file({.format = Encoding::ascii}), ":16", "vertex 6 is out of range");
    expect_failure("indexb.vtu", index.file({}), ":15: DataArray 'connectivity': byte 40",
                   "vertex 6 is out of range");
    Example nan;
    nan.points[4] = std::numeric_limits<double>::quiet_NaN();
    expect_failure("nan.vtu", nan.file({.format = Encoding::ascii}), ":11",
                   "coordinate y 'nan' is not finite");
    expect_failure("nanb.vtu", nan.file({.wide = true}), ":10: DataArray 'Points': byte 32", "is not finite");
    expect_failure("nanr.vtu", nan.file({Encoding::raw, true}), ":10: DataArray 'Points': byte 16",
                   "is not finite");
    Example order;
    order.offsets = {7, 3, 11};
    expect_failure("order.vtu", order.file({}), ":18: DataArray 'offsets': byte 4", "offset 3 is below");
}

TEST(Vtu, BadCounts) {
    const auto text = ascii();
    expect_failure("points.vtu", replaced(text, "Points=\"6\"", "Points=\"66666\""), ":10",
                   "66666 points announced");
    expect_failure("less.vtu", replaced(text, "Points=\"6\"", "Points=\"5\""), ":11",
                   "more numbers than announced");
    expect_failure("cells.vtu", replaced(text, "Cells=\"3\"", "Cells=\"99999\""), ":",
                   "99999 offsets announced");
    expect_failure("count.vtu", replaced(text, "Points=\"6\"", "Points=\"six\""), ":5", "found 'six'");
    const auto binary = Example().file({});
    expect_failure("pointsb.vtu", replaced(binary, "Points=\"6\"", "Points=\"7777777\""),
                   ":10: DataArray 'Points'", "7777777 points announced");
}

TEST(Vtu, BadData) {
    const auto raw = Example().file({.format = Encoding::raw, .wide = true});
    const auto start = raw.find("\n_") + 2;
    auto large = raw;
    large[start + 6] = 1;
    expect_failure("large.vtu", large, ":10", "the data end before");
    expect_failure("offset.vtu", replaced(raw, "offset=\"0\"", "offset=\"99999\""), ":10",
                   "offset '99999' is not inside");
    auto packed = Example().file({.format = Encoding::raw, .compressed = true});
    const auto head = packed.find("\n_") + 2;
    auto parts = packed;
    parts[head + 2] = 1;
    expect_failure("parts.vtu", parts, ":10", "the data end before");
    auto whole = packed;
    whole[head + 7] = 1;
    expect_failure("whole.vtu", whole, ":10", "cannot contain");
    packed[head + 12 + 12 + 5] ^= 0x55;
    expect_failure("broken.vtu", packed, ":10", "part 0 does not decompress");
    auto letters = Example().file({});
    letters[letters.find("\"binary\">\n") + 14] = '!';
    expect_failure("letters.vtu", letters, ":10", "not base64");
}

TEST(Vtu, BadStructure) {
    const auto text = ascii();
    expect_failure("cut.vtu", text.substr(0, text.find("</UnstructuredGrid>")), ":26",
                   "the file ends before </VTKFile>");
    expect_failure("open.vtu", text.substr(0, text.find("</VTKFile") + 5), ":", "a tag without '>'");
    expect_failure("kind.vtu", replaced(text, "\"UnstructuredGrid\"", "\"PolyData\""), ":3",
                   "'PolyData' is not supported");
    expect_failure("packed.vtu",
                   replaced(text, "byte_order", "compressor=\"vtkZstdDataCompressor\" byte_order"), ":3",
                   "compressor 'vtkZstdDataCompressor' is not supported");
    expect_failure("type.vtu", replaced(text, "\"Float64\"", "\"String\""), ":10", "number type 'String'");
    expect_failure("header.vtu", replaced(text, "UInt64", "UInt16"), ":3", "unknown header_type 'UInt16'");
    expect_failure("lacks.vtu", replaced(text, "\"offsets\"", "\"ends\""), ":5", "Piece lacks");
    expect_failure("other.vtu", "<?xml version=\"1.0\"?>\n<html></html>", ":1", "expected the tag VTKFile");
}

/// A file truncated before the end of its data gives an error, never a crash.
TEST(Vtu, Truncated) {
    for (const auto format : {Encoding::ascii, Encoding::inlined, Encoding::appended, Encoding::raw}) {
        const auto whole = Example().file({format, true, true});
        const auto end = whole.find(format < Encoding::appended ? "</VTKFile" : "</AppendedData");
        for (std::size_t size = 0; size + 1 < end; size += 5)
            expect_failure("cut.vtu", whole.substr(0, size), ":", "; ");
    }
}

} // namespace
} // namespace tandem::loader
