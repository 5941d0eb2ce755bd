// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tandem {

/// Settings and the values of each, in order, from texts "NAME=V1,V2", where a value may be a range
/// (ranges.h). Throws InputError.
std::vector<std::pair<std::string, std::vector<std::string>>>
parse_sets(const std::vector<std::string>& texts);

/// Options of a command and the texts of its --set, which are read after the line.
template<class Options>
struct Given {
    Options options;
    std::vector<std::string> sets;
};

} // namespace tandem
