// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace CLI {
class App;
}

namespace tandem {

/// Throws InputError for the first given option that excludes another given one, or that requires an absent
/// one. So no option is silently ignored. Call it after the line has been read.
void refuse_contradictions(const CLI::App& command);

/// Whether an option of the line excludes `option`, which is "--name" or "--name=value".
bool conflicts_with_line(const CLI::App& command, std::string_view option);

} // namespace tandem
