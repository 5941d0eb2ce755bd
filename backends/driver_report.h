// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tandem {

/// A driver that is registered with the loader of its backend, whether it works or not.
struct DriverReport {
    struct Platform {
        std::string name;
        std::size_t devices = 0;
    };

    std::string file;                ///< that registers it; empty when a variable names the library
    std::string library;             ///< as it is registered; empty when the file names none
    std::vector<Platform> platforms; ///< those that the library lists
    std::string problem;             ///< why it fails, in one sentence part; empty when it works
};

} // namespace tandem
