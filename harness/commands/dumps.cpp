// SPDX-License-Identifier: MIT
#include "harness/commands/dumps.h"

#include "base/error.h"
#include "base/files_in_use.h"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <iterator>
#include <sys/stat.h>
#include <unistd.h>

namespace tandem {

namespace {

/// Lines are written in pieces of about this size, because a frame can have millions of them.
constexpr std::size_t piece_bytes = 1 << 20;

} // namespace

DumpFile::DumpFile(const std::string& path, std::string_view header) : path_(path) {
    if (path.empty()) return;
    file_.reset(std::fopen(path.c_str(), "a")); // keeps the content until it may be overwritten
    if (!file_)
        throw InputError(
            fmt::format("{}: cannot be written ({}); choose another file", path, std::strerror(errno)));
    refuse_overwriting(fileno(file_.get()), path);
    note_output(path);
    try {
        clear();
        write(header);
    } catch (const OutputError& error) { // nothing is measured yet
        throw InputError(fmt::format("{}; choose another file", error.what()));
    }
}

/// A pipe or a terminal has nothing to clear.
void DumpFile::clear() const {
    struct stat facts {};
    const int descriptor = fileno(file_.get());
    if (fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode) && ftruncate(descriptor, 0) != 0)
        throw OutputError(fmt::format("{}: cannot be shortened ({})", path_, std::strerror(errno)));
}

void DumpFile::write(std::string_view text) const {
    const bool whole = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
    if (!whole || std::fflush(file_.get()) != 0)
        throw OutputError(fmt::format("{}: writing failed ({})", path_, std::strerror(errno)));
}

void DumpFile::write_pieces(std::string& text, std::size_t least) const {
    if (text.size() < least) return;
    write(text);
    text.clear();
}

void DumpFile::pairs(std::size_t frame, std::span<const Pair> pairs) {
    std::string text;
    for (const auto& p : pairs) {
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", frame, p.body_a, p.tet_a, p.body_b,
                       p.tet_b);
        write_pieces(text, piece_bytes);
    }
    write_pieces(text, 1);
}

void DumpFile::contacts(std::size_t frame, std::span<const ContactPoint> contacts) {
    std::string text;
    for (const auto& c : contacts) {
        fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{}\n", frame,
                       c.pair.body_a, c.pair.tet_a, c.pair.body_b, c.pair.tet_b, c.point[0], c.point[1],
                       c.point[2], c.normal[0], c.normal[1], c.normal[2], c.depth);
        write_pieces(text, piece_bytes);
    }
    write_pieces(text, 1);
}

void DumpFile::chunks(std::size_t number, const Mesh& mesh, std::span<const std::uint32_t> order,
                      std::uint32_t leaves) {
    std::string text;
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

} // namespace tandem
