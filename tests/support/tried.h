// SPDX-License-Identifier: MIT
#pragma once

#include "harness/program/environment.h"

#include <cstdint>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>

namespace tandem::support {

/// Appends a line to the file that TANDEM_TRIED names, if it is set: `count` `unit`s of `what` were tried on
/// `where`, and `lost` answers or records were lost. tests/program.py has the same function.
inline void tried(std::string_view what, std::uint64_t count, std::string_view unit, std::string_view where,
                  std::uint64_t lost) {
    const char* path = std::getenv("TANDEM_TRIED");
    if (path == nullptr) return;
    const auto line = version_line();
    const auto at = line.find("commit ") + 7;
    std::ofstream(path, std::ios::app) << fmt::format(
        R"({{"what":"{}","count":{},"unit":"{}","where":"{}","lost":{},"crashes":0,"hangs":0,"others":0,"commit":"{}"}})"
        "\n",
        what, count, unit, where, lost, line.substr(at, line.find(',', at) - at));
}

} // namespace tandem::support
