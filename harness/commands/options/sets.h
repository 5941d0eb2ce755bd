// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tandem {

/// The settings and their values, in order, from texts "NAME=V1,V2". A value may be a range (see ranges.h).
/// Throws InputError.
std::vector<std::pair<std::string, std::vector<std::string>>>
parse_sets(const std::vector<std::string>& texts);

/// The options of a command and the texts of its --set, which are parsed after the line has been read.
template<class Options>
struct Given {
    Options options;
    std::vector<std::string> sets;
};

} // namespace tandem
