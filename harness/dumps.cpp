// SPDX-License-Identifier: MIT
#include "harness/dumps.h"

#include "scenes/error.h"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>

namespace tandem {

DumpFile::DumpFile(const std::string& path, std::string_view header) : path_(path) {
    if (path.empty()) return;
    file_.reset(std::fopen(path.c_str(), "w"));
    if (!file_)
        throw InputError(
            fmt::format("{}: cannot be written ({}); choose another file", path, std::strerror(errno)));
    fmt::print(file_.get(), "{}", header);
    check();
}

void DumpFile::check() const {
    if (std::fflush(file_.get()) != 0)
        throw InputError(fmt::format("{}: writing failed ({})", path_, std::strerror(errno)));
}

void DumpFile::pairs(std::size_t frame, std::span<const Pair> pairs) {
    for (const auto& p : pairs)
        fmt::print(file_.get(), "{},{},{},{},{}\n", frame, p.body_a, p.tet_a, p.body_b, p.tet_b);
    check();
}

void DumpFile::contacts(std::size_t frame, std::span<const ContactPoint> contacts) {
    for (const auto& c : contacts)
        fmt::print(file_.get(), "{},{},{},{},{},{},{},{},{},{},{},{}\n", frame, c.pair.body_a, c.pair.tet_a,
                   c.pair.body_b, c.pair.tet_b, c.point[0], c.point[1], c.point[2], c.normal[0], c.normal[1],
                   c.normal[2], c.depth);
    check();
}

} // namespace tandem
