// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace tandem::report {

/// A file of the page, by its name without folders, as it was when the program was built; empty where the
/// build found none (cmake/report_page.cmake).
std::string_view asset(std::string_view name);

} // namespace tandem::report
