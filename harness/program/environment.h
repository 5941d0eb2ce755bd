// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tandem {

/// The machine and the program that made a record; no host name. Unknown values are empty or 0.
struct Environment {
    std::string commit;
    bool dirty = false;
    std::string date; ///< UTC, ISO 8601
    std::string processor;
    std::uint32_t cores = 0;
    std::uint64_t memory = 0; ///< bytes
    std::string compiler;
};

/// The environment of this process at the time of the call. Never throws: values that cannot be read stay
/// unknown.
Environment environment();

/// The output of `tandem --version`: "tandem 0.2.0, commit 0123456789ab, dirty, g++ 12.2.0, with Embree
/// 3.13.5, ...".
std::string version_line();

/// A random identifier of 16 hexadecimal digits, shared by all records of one run of the program.
const std::string& session_id();

/// A digest of 16 hexadecimal digits over the sources of the program, including its kernels.
std::string sources_digest();

/// The command line as the user gave it, with the program's folder removed; empty when unknown.
std::string command_line();

/// Removes the folders of absolute paths from a line, because they can identify the machine or its user.
std::string without_folders(std::string_view line);

} // namespace tandem
