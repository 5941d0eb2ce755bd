// SPDX-License-Identifier: MIT
#include "harness/commands/dump_file.h"

#include <fmt/format.h>
#include <iterator>
#include <utility>

namespace tandem {

namespace {

/// Lines are written in pieces of about this size, because a frame can have millions of them.
constexpr std::size_t piece_bytes = 1 << 20;

} // namespace

/// The header before the first line. It comes with the lines, because pipes are written directly.
std::string DumpFile::begun() { return std::exchange(header_, {}); }

void DumpFile::write_pieces(std::string& text, std::size_t least) {
    if (text.size() < least) return;
    file_.write(text);
    text.clear();
}

void DumpFile::pairs(std::size_t frame, std::span<const Pair> pairs) {
    auto text = begun();
    for (const auto& p : pairs) {
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", frame, p.body_a, p.tet_a, p.body_b,
                       p.tet_b);
        write_pieces(text, piece_bytes);
    }
    write_pieces(text, 1);
}

void DumpFile::rows(std::size_t frame, std::span<const ContactPoint> contacts,
                    std::span<const RowColumn> columns) {
    auto text = begun();
    for (const auto& c : contacts) {
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}", frame, c.pair.body_a, c.pair.tet_a,
                       c.pair.body_b, c.pair.tet_b);
        std::array<double, 3> room;
        for (const auto& column : columns)
            for (const double number : column.values(c, room))
                fmt::format_to(std::back_inserter(text), ",{}", number);
        text += '\n';
        write_pieces(text, piece_bytes);
    }
    write_pieces(text, 1);
}

void DumpFile::chunks(std::size_t number, const Mesh& mesh, std::span<const std::uint32_t> order,
                      std::uint32_t leaves) {
    auto text = begun();
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto chunk = i / leaves;
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}", number, order[i], i, chunk,
                       chunk / leaves);
        for (const auto vertex : mesh.tetrahedra[order[i]]) {
            const auto& at = mesh.vertices[vertex];
            fmt::format_to(std::back_inserter(text), ",{},{},{}", at.x(), at.y(), at.z());
        }
        text += '\n';
        write_pieces(text, piece_bytes);
    }
    write_pieces(text, 1);
}

void DumpFile::finish() {
    file_.write(begun());
    file_.finish();
}

} // namespace tandem
