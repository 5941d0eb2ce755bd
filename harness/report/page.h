// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tandem::report {

/// A page that needs nothing else.
struct Page {
    std::string title{};
    std::vector<std::pair<std::string, std::string>> data{}; ///< {id, JSON text}
    bool has_scene = false, has_charts = false;              ///< which libraries it takes
};

/// Throws InputError, one line, where the program was built without a library that the page takes.
void check_libraries(const Page& page);

/// The page as HTML.
std::string html_of(const Page& page);

/// Bytes of a page less its data.
std::size_t empty_bytes(Page page);

/// Replaces the file, whole or not at all. Throws OutputError.
void write_page(const std::string& path, const std::string& html);

} // namespace tandem::report
