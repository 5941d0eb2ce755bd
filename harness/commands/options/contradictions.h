// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace CLI {
class App;
}

namespace tandem {

/// Options of a command that say no to each other, or that say nothing without another: throws InputError for
/// the first that the line has, so that none is silently left out. After the line has been read.
void refuse_contradictions(const CLI::App& command);

/// Whether an option that the line gives does not go with `option`, which is "--name" or "--name=value".
bool line_speaks_against(const CLI::App& command, std::string_view option);

} // namespace tandem
