// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tandem {

/// Where and with what a record was made; no host name. Empty or 0 when unknown.
struct Environment {
    std::string commit;
    bool dirty = false;
    std::string date; ///< UTC, ISO 8601
    std::string processor;
    std::uint32_t cores = 0;
    std::uint64_t memory = 0; ///< bytes
    std::string compiler;
};

/// Of this process, now. Never throws: what cannot be read is unknown.
Environment environment();

/// "tandem 0.1.0, commit 0123456789ab, dirty, g++ 12.2.0, with Embree 3.13.5, ...": what `tandem --version`
/// prints.
std::string version_line();

/// 16 hexadecimal digits of chance: of all records of one run of the program, and of no other.
const std::string& session_id();

/// 16 hexadecimal digits of the sources that the program was built from, those of its kernels included.
std::string sources_digest();

/// As it was given, the program without its folder; empty when unknown.
std::string command_line();

/// A line without the folders of its absolute paths, which say whose machine it was.
std::string without_folders(std::string_view line);

} // namespace tandem
