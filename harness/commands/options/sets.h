// SPDX-License-Identifier: MIT
#pragma once

#include "harness/plans/cells.h"

namespace CLI {
class App;
}

namespace tandem {

/// Adds --set. Texts "NAME=V1,V2" become settings of the request, in order; a value may be a range (see
/// ranges.h). Parsing throws InputError.
void add_set_option(CLI::App& app, Request& request, const std::string& help);

} // namespace tandem
