// SPDX-License-Identifier: MIT
// What `tandem help` explains.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tandem {

/// The words that it takes: the commands of the program `app`, algorithms, settings, and "settings".
std::vector<std::string> topic_names(const CLI::App& app);

} // namespace tandem
