// SPDX-License-Identifier: MIT
// Folders for data that tandem executes or trusts when it reads it again: only this user may write to them.
#pragma once

#include <filesystem>
#include <string>

namespace tandem {

/// Creates a folder that only this user can access, unless it exists.
std::error_code make_own(const std::filesystem::path& folder);

/// Why no file can be written in a folder, as the system words it; empty when one can. Creates a missing
/// folder. Writes a file of one byte and removes it: permissions alone do not tell that a disk is full or
/// read-only.
std::string why_not_writable(const std::filesystem::path& folder);

/// Why other users may have written to an existing folder, and what to do; empty when they cannot have.
std::string why_not_own(const std::filesystem::path& folder);

} // namespace tandem
