// SPDX-License-Identifier: MIT
// Folders for what is run or believed when it is read again: nobody but this user may write to them.
#pragma once

#include <filesystem>
#include <string>

namespace tandem {

/// Makes a folder, with rights of this user alone, unless it is there.
std::error_code make_own(const std::filesystem::path& folder);

/// Why others may have written to a folder that is there, and what to do; empty where they cannot have.
std::string why_not_own(const std::filesystem::path& folder);

} // namespace tandem
