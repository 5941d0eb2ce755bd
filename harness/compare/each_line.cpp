// SPDX-License-Identifier: MIT
#include "harness/compare/each_line.h"

#include "scenes/error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

namespace tandem::compare {

bool each_line(const std::string& path, const std::function<void(const std::string&, std::size_t)>& take) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw InputError(fmt::format("{}: is a folder; name a file of records", path));
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw InputError(
            fmt::format("{}: cannot be read ({}); name a file of records", path, std::strerror(errno)));
    std::string text;
    for (std::size_t line = 1; std::getline(in, text); ++line) {
        if (in.eof()) return true;
        take(text, line);
    }
    if (in.bad()) throw InputError(fmt::format("{}: reading failed; name another file", path));
    return false;
}

} // namespace tandem::compare
