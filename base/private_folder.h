// SPDX-License-Identifier: MIT
// Folders for data that tandem executes or trusts when it reads it again: only this user may write to them.
#pragma once

#include <filesystem>
#include <string>

namespace tandem {

/// Creates a folder that only this user can access, unless it exists.
std::error_code make_own(const std::filesystem::path& folder);

/// Why other users may have written to an existing folder, and what to do; empty when they cannot have.
std::string why_not_own(const std::filesystem::path& folder);

} // namespace tandem
